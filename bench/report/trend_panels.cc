// SPDX-License-Identifier: Apache-2.0
#include "bench/report/trend_panels.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "analysis/interval_95.h"
#include "analysis/quantities.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"
#include "bench/report/svg_text.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kPanels_a_picture = 3;
constexpr std::size_t kPointsDrawn = 300;
constexpr std::array<std::string_view, 6> kLineColours{"#0072B2", "#D55E00", "#009E73",
                                                       "#CC79A7", "#E69F00", "#56B4E9"};

struct DrawnSeries {
  std::vector<double> cycle, value, low, high;
};

DrawnSeries PointsOf(const QuantitySeries& series) {
  DrawnSeries drawn;
  const std::size_t count = series.cycle.size();
  const std::size_t step = (count + kPointsDrawn - 1) / kPointsDrawn;
  for (std::size_t i = 0; i < count; i = i + 1 == count ? count : std::min(i + step, count - 1)) {
    const analysis::Estimate& value = series.value[i];
    const double half_width = analysis::HalfWidthOf95(value);
    drawn.cycle.push_back(series.cycle[i]);
    drawn.value.push_back(value.value);
    drawn.low.push_back(value.value - half_width);
    drawn.high.push_back(value.value + half_width);
  }
  return drawn;
}

bool HasTrend(const std::string& quantity) {
  const std::string_view unit = analysis::UnitOf(quantity);
  return unit != "s" && unit != "us";
}

// No further from the band than that is high, so that the trend stays to be seen.
bool IsNear(const DrawnSeries& drawn, double limit) {
  const double low = std::ranges::min(drawn.low);
  const double high = std::ranges::max(drawn.high);
  return limit > low - (high - low) && limit < high + (high - low);
}

// Control limits and stop criterion, as horizontal lines.
std::string LinesBeside(const CampaignSheet& sheet, const std::string& quantity, const DrawnSeries& drawn) {
  std::string lines;
  if (const auto found = sheet.control_limits.find(quantity); found != sheet.control_limits.end()) {
    for (const double limit : {found->second.limits.lower, found->second.limits.upper})
      lines +=
          fmt::format(", {:.8g} with lines dashtype 3 linewidth 1 linecolor rgb '#444444' notitle", limit);
  }
  const auto stop = StopLimitOf(sheet.inputs.schedule.stop, sheet.first_k2_Nm_per_rad, quantity);
  if (stop && IsNear(drawn, stop->limit))
    lines += fmt::format(", {:.8g} with lines dashtype 2 linewidth 1.5 linecolor rgb '#444444' notitle",
                         stop->limit);
  return lines;
}

std::string PanelScript(std::span<const CampaignSheet> sheets, const std::string& quantity,
                        std::string& data) {
  std::string bands;
  std::string lines;
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const DrawnSeries drawn = PointsOf(sheets[i].series.at(quantity));
    const std::string block = fmt::format("series_{}", data.size());
    data += DataBlock(block, {drawn.cycle, drawn.value, drawn.low, drawn.high});
    const std::string_view colour = kLineColours[i % kLineColours.size()];
    bands += fmt::format("{}${} using 1:3:4 with filledcurves linecolor rgb '{}' notitle", i == 0 ? "" : ", ",
                         block, colour);
    lines += fmt::format(
        ", ${} using 1:2 with {} linewidth 1.5 linecolor rgb '{}' {}", block,
        drawn.cycle.size() <= 60 ? "linespoints pointtype 7 pointsize 0.5" : "lines", colour,
        sheets.size() > 1
            ? "title " + Quoted(fmt::format("{} {}", i + 1, sheets[i].inputs.schedule.specimen.identity))
            : "notitle");
  }
  const std::string beside =
      sheets.size() == 1 ? LinesBeside(sheets.front(), quantity, PointsOf(sheets.front().series.at(quantity)))
                         : std::string();
  return fmt::format("set title {}\nplot {}{}{}\n", Quoted(HeadOf(quantity)), bands, lines, beside);
}

}  // namespace

std::vector<std::string> DrawTrendPanels(std::span<const CampaignSheet> sheets,
                                         const std::vector<std::string>& quantities) {
  std::vector<std::string> drawn = quantities;
  std::erase_if(drawn, [](const std::string& quantity) { return !HasTrend(quantity); });
  std::vector<std::string> pictures;
  const ScratchFolder scratch;
  for (std::size_t from = 0; from < drawn.size(); from += kPanels_a_picture) {
    const std::size_t panels = std::min(kPanels_a_picture, drawn.size() - from);
    std::string data;
    std::string plots;
    for (std::size_t k = 0; k < panels; ++k) {
      if (k + 1 == panels) plots += "set xlabel 'cycle' offset 0,0.5\n";
      plots += PanelScript(sheets, drawn[from + k], data);
    }
    const std::string script = data + CommonStyle() +
                               "set lmargin 10\nset rmargin 3\nset tmargin 2\nset bmargin 3\nset title "
                               "offset 0,-0.6 font ',16'\nset offsets "
                               "0,0,graph 0.08,graph 0.08\nset key at graph 1,1 right bottom horizontal\n" +
                               fmt::format("set multiplot layout {},1\n", panels) + plots +
                               "unset multiplot\n";
    const auto stem = scratch.path() / fmt::format("trends_{}", from);
    pictures.push_back(SvgText(RenderPicture(script, stem, {1000, 20 + 250 * static_cast<int>(panels)})));
  }
  return pictures;
}

}  // namespace strainwave::bench
