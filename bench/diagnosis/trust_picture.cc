// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "bench/diagnosis/picture_frame.h"
#include "bench/diagnosis/trust_report.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using diagnosis::RegressorRange;
using diagnosis::Validity;

constexpr double kPanelHeight_px = 190.0;
constexpr double kPanelGap_px = 76.0;
// Of one value of a regressor that has few: its bar is as wide as this share of the least distance of two.
constexpr double kBarOfValue = 0.3;

// Edges of bars, as gnuplot's boxxyerror takes them.
struct Bars {
  std::vector<double> left, right, top;
};

double HalfWidthOfValue(const std::vector<RegressorRange>& ranges) {
  double distance = ranges.back().high - ranges.front().low;
  for (std::size_t k = 1; k < ranges.size(); ++k)
    distance = std::min(distance, ranges[k].low - ranges[k - 1].low);
  return kBarOfValue * distance;
}

// What one panel draws of one model, by the result of its test.
std::array<Bars, 3> BarsOf(const std::vector<RegressorRange>& ranges, bool extended, double per_unit,
                           double unit) {
  std::array<Bars, 3> bars;
  const double half = HalfWidthOfValue(ranges);
  for (const RegressorRange& range : ranges) {
    const diagnosis::RangeError& error = extended ? range.extended : range.nominal;
    const bool value = range.low == range.high;
    double low = value ? range.low - half : range.low;
    double high = value ? range.high + half : range.high;
    if (extended) {  // narrower, so that the other one shows behind it
      const double margin = 0.2 * (high - low);
      low += margin;
      high -= margin;
    }
    Bars& of = bars[static_cast<std::size_t>(error.validity)];
    of.left.push_back(low * per_unit);
    of.right.push_back(high * per_unit);
    of.top.push_back(error.rmse * unit);
  }
  return bars;
}

std::string_view ColourOf(bool extended, Validity validity) {
  const PictureColour& colour = extended ? kFirstColour : kLastColour;
  switch (validity) {
    case Validity::kHolds:
      return colour.pale;
    case Validity::kFails:
      return colour.plain;
    case Validity::kTooFew:
      return "#CCCCCC";
  }
  return {};
}

}  // namespace

std::filesystem::path DrawTrustedRegions(const DiagnosisReport& report, const std::filesystem::path& stem) {
  const diagnosis::Study& study = *report.input.study;
  const diagnosis::TrustedRegions& trusted = report.result.trusted;
  const double unit = study.unit_per_si();
  std::vector<std::size_t> drawn;
  for (std::size_t k = 0; k < trusted.over.size(); ++k)
    if (!trusted.over[k].empty()) drawn.push_back(k);
  const PanelLayout layout = StackPanels(drawn.size(), kPanelHeight_px, kPanelGap_px);
  const double tolerated = diagnosis::kToleratedExcess * trusted.noise * unit;
  std::string data;
  std::string script =
      CommonStyle() + TitleLabel(TitleOf(report, "where the simulation may be trusted"), layout.height_px) +
      fmt::format("set multiplot\nset lmargin at screen {}\nset rmargin at screen 0.975\nunset key\n",
                  kPanelLeft) +
      fmt::format("set style fill solid 1 noborder\nset ylabel {}\n",
                  Quoted(fmt::format("error ({})", study.unit())));
  std::vector<LegendEntry> legend{{kLastColour.plain, NominalName(report)}};
  if (IsExtended(report)) legend.push_back({kFirstColour.plain, "with the causes found"});
  legend.push_back({"#999999", "too few samples"});
  legend.push_back(
      {"#444444",
       fmt::format("pale: holds; dark: fails; dashed: {:g} times the noise", diagnosis::kToleratedExcess),
       false});
  script += Legend(legend, layout.panels.front(), layout.height_px);
  for (std::size_t panel = 0; panel < drawn.size(); ++panel) {
    const diagnosis::Regressor& regressor = study.regressors()[drawn[panel]];
    const std::vector<RegressorRange>& ranges = trusted.over[drawn[panel]];
    script += PanelMargins(layout.panels[panel]);
    double top = tolerated;
    std::string plot;
    for (const bool extended : {false, true}) {
      if (extended && !IsExtended(report)) continue;
      const std::array<Bars, 3> bars = BarsOf(ranges, extended, regressor.per_unit, unit);
      for (std::size_t result = 0; result < bars.size(); ++result) {
        if (bars[result].left.empty()) continue;
        const std::string name = fmt::format("bars{}_{}_{}", panel, extended ? 1 : 0, result);
        data += DataBlock(name, {bars[result].left, bars[result].right, bars[result].top});
        plot += fmt::format(
            "${} using (0.5*($1+$2)):(0.5*$3):1:2:(0):3 with boxxyerror linecolor rgb '{}',\\\n  ", name,
            ColourOf(extended, static_cast<Validity>(result)));
        top = std::max(top, *std::ranges::max_element(bars[result].top));
      }
    }
    const double half = ranges.front().low == ranges.front().high ? 2.0 * HalfWidthOfValue(ranges) : 0.0;
    script +=
        fmt::format("set xlabel {} offset 0,0.4\nset xrange [{:.6g}:{:.6g}]\nset yrange [0:{:.6g}]\n",
                    Quoted(AxisTitle(regressor.title)), (ranges.front().low - half) * regressor.per_unit,
                    (ranges.back().high + half) * regressor.per_unit, 1.1 * top);
    script += fmt::format(
        "plot {}{:.6g} with lines linewidth 1.2 dashtype 2 linecolor rgb '{}'\nunset label 1000\n", plot,
        tolerated, kMeasuredColour);
  }
  return RenderPicture(data + script + "unset multiplot\n", stem,
                       {.width_px = 1200, .height_px = static_cast<int>(layout.height_px)});
}

}  // namespace strainwave::bench
