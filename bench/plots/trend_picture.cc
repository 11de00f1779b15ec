// SPDX-License-Identifier: Apache-2.0
#include "bench/plots/trend_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

constexpr int kPanelHeight_px = 230;
constexpr int kFrameHeight_px = 125;  // title above and axis below
constexpr std::array<std::string_view, 4> kColours{"#0072B2", "#009E73", "#CC79A7", "#D55E00"};

void Check(const Trend& trend) {
  if (trend.value.size() != trend.cycle.size() || trend.standard_error.size() != trend.cycle.size()) {
    throw std::invalid_argument(
        fmt::format("the trend '{}' has {} cycles, {} values and {} standard errors "
                    "(expected one length)",
                    trend.label, trend.cycle.size(), trend.value.size(), trend.standard_error.size()));
  }
  if (std::none_of(trend.value.begin(), trend.value.end(),
                   [](double value) { return std::isfinite(value); })) {
    throw std::invalid_argument(
        fmt::format("the trend '{}' holds no value (expected at least one)", trend.label));
  }
}

std::vector<double> Shifted(const Trend& trend, double sign) {
  std::vector<double> edge(trend.value.begin(), trend.value.end());
  for (std::size_t i = 0; i < edge.size(); ++i) {
    if (std::isfinite(trend.standard_error[i])) {
      edge[i] += sign * trend.standard_error[i];
    }
  }
  return edge;
}

// First and last cycle over all panels, so that they share an axis even where one has gaps at its ends.
std::pair<double, double> CycleRange(std::span<const Trend> trends) {
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  for (const Trend& trend : trends) {
    const auto [lowest, highest] = std::minmax_element(trend.cycle.begin(), trend.cycle.end());
    first = std::min(first, *lowest);
    last = std::max(last, *highest);
  }
  return {first, last};
}

}  // namespace

std::filesystem::path DrawTrends(const std::string& title, std::span<const Trend> trends,
                                 const std::filesystem::path& stem) {
  if (trends.empty()) {
    throw std::invalid_argument("trends is empty (expected at least one)");
  }
  for (const Trend& trend : trends) Check(trend);
  const int panels = static_cast<int>(trends.size());
  const int height_px = panels * kPanelHeight_px + kFrameHeight_px;
  const auto [first, last] = CycleRange(trends);
  // With few cycles the points carry the picture, with many they would hide the line.
  const bool few = last - first <= 100.0;
  const double margin = std::max(0.5, 0.01 * (last - first));

  std::string data;
  std::string plots;
  const double top = 1.0 - 70.0 / height_px;
  const double panel = (1.0 - static_cast<double>(kFrameHeight_px) / height_px) / panels;
  for (int i = 0; i < panels; ++i) {
    const Trend& trend = trends[static_cast<std::size_t>(i)];
    const std::string_view colour = kColours[static_cast<std::size_t>(i) % kColours.size()];
    data += DataBlock(fmt::format("trend_{}", i),
                      {trend.cycle, trend.value, Shifted(trend, -1.0), Shifted(trend, +1.0)});
    const bool lowest = i + 1 == panels;
    plots += fmt::format("set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n", top - i * panel,
                         top - (i + 1) * panel + 0.12 * panel);
    plots += fmt::format("set title {} font ',18' offset 0,0.5\n", Quoted(i == 0 ? title : ""));
    plots += lowest ? "set format x '%g'\nset xlabel 'cycle'\n" : "set format x ''\nset xlabel ''\n";
    plots += fmt::format("set ylabel {}\n", Quoted(fmt::format("{} ({})", trend.label, trend.unit)));
    plots +=
        fmt::format("set key {}\n",
                    i == 0 ? "at graph 1,1 right bottom vertical maxrows 1 Left reverse samplen 2" : "off");
    plots += fmt::format(
        "plot $trend_{0} using 1:3:4 with filledcurves linecolor rgb '{1}' title '± standard error',\\\n"
        "  $trend_{0} using 1:2 with {2} title 'value'\n",
        i, colour,
        few ? fmt::format("linespoints linewidth 1.6 pointtype 7 pointsize 0.6 linecolor rgb '{}'", colour)
            : fmt::format("lines linewidth 1.2 linecolor rgb '{}'", colour));
  }
  std::string script = data + CommonStyle();
  script += "set lmargin at screen 0.12\nset rmargin at screen 0.97\n";
  script +=
      fmt::format("set xrange [{}:{}]\nset ytics 1,1\nset ytics autofreq\n", first - margin, last + margin);
  script += "set offsets 0,0,graph 0.08,graph 0.08\n";
  script += "set multiplot\n" + plots + "unset multiplot\n";
  return RenderPicture(script, stem, {.width_px = 1100, .height_px = height_px});
}

}  // namespace strainwave::bench
