// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "analysis/interval_95.h"
#include "bench/diagnosis/picture_frame.h"
#include "bench/diagnosis/specimens_report.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using analysis::statistics::GroupEstimate;
using diagnosis::SpecimenComparison;
using diagnosis::SpecimenSize;

constexpr double kRow_px = 26.0;
constexpr double kGapAbovePanel_px = 84.0;
constexpr int kForest_px = 1200;

// One component of the sizes as marks with their 95 % intervals: value, row, low and high.
struct ForestMarks {
  std::vector<double> value, row, low, high;
  double mean{};
  double tau{};

  void Add(double at, double error, double y) {
    const double half = analysis::kStandardErrorsOf95 * error;
    value.push_back(at);
    row.push_back(y);
    low.push_back(at - half);
    high.push_back(at + half);
  }
};

// Of a size its only component; of a vector what lies along the mean, and across it.
std::vector<ForestMarks> MarksOf(const SpecimenComparison& comparison) {
  const auto& effects = *comparison.effects;
  Eigen::VectorXd along = Eigen::VectorXd::Ones(1);
  std::vector<Eigen::VectorXd> directions{along};
  if (comparison.phases) {
    along = effects.mean / std::max(effects.mean.norm(), 1e-300);
    directions = {along, Eigen::Vector2d(-along(1), along(0))};
  }
  std::vector<ForestMarks> marks;
  for (const Eigen::VectorXd& direction : directions) {
    ForestMarks& of = marks.emplace_back();
    of.mean = direction.dot(effects.mean);
    of.tau = effects.tau;
    const double shift = !comparison.phases ? 0.0 : marks.size() == 1 ? 0.12 : -0.12;
    for (std::size_t i = 0; i < comparison.sizes.size(); ++i) {
      const SpecimenSize& size = comparison.sizes[i];
      if (!size.amount) continue;
      const double y = shift - static_cast<double>(i);
      if (!size.phase) {
        of.Add(size.amount->value, size.amount->standard_error, y);
        continue;
      }
      const GroupEstimate estimate = diagnosis::VectorOf(*size.amount, *size.phase);
      of.Add(direction.dot(estimate.value), std::sqrt(direction.dot(estimate.covariance * direction)), y);
    }
  }
  return marks;
}

std::string RowNames(const SpecimensReport& report) {
  std::string names;
  for (std::size_t i = 0; i < report.specimens.size(); ++i) {
    names += fmt::format("{}{} {:g}", i == 0 ? "" : ", ", Quoted(report.specimens[i].name),
                         -static_cast<double>(i));
  }
  return names;
}

// A band of the mean ± τ, the mean as a line, the marks with their intervals.
std::string PlotOf(const std::vector<ForestMarks>& marks, std::size_t panel, std::size_t rows,
                   std::string& data) {
  std::string bands;
  std::string points;
  std::vector<double> edges{0.0};
  for (std::size_t k = 0; k < marks.size(); ++k) {
    const PictureColour& colour = k == 0 ? kFirstColour : kLastColour;
    const ForestMarks& of = marks[k];
    const std::string name = fmt::format("marks{}_{}", panel, k);
    data += DataBlock(name, {of.value, of.row, of.low, of.high});
    bands += fmt::format(
        "set object {} rectangle from first {:.8g}, graph 0 to first {:.8g}, graph 1 behind fillstyle "
        "transparent "
        "solid 0.35 noborder fillcolor rgb '{}'\nset arrow {} from first {:.8g}, graph 0 to first {:.8g}, "
        "graph 1 "
        "nohead dashtype 2 linewidth 1.2 linecolor rgb '{}'\n",
        k + 1, of.mean - of.tau, of.mean + of.tau, colour.pale, k + 1, of.mean, of.mean, colour.dark);
    points += fmt::format("{}${} using 1:2:3:4 with xerrorbars pointtype 7 linewidth 2 linecolor rgb '{}'",
                          k == 0 ? "plot " : ", ", name, colour.plain);
    edges.insert(edges.end(), of.low.begin(), of.low.end());
    edges.insert(edges.end(), of.high.begin(), of.high.end());
    edges.insert(edges.end(), {of.mean - of.tau, of.mean + of.tau});
  }
  return fmt::format("unset object\nunset arrow\n{}set xrange {}\nset yrange [{:g}:0.6]\n", bands,
                     RangeText(edges), -static_cast<double>(rows) + 0.4) +
         points + "\n";
}

}  // namespace

bool HasSpecimensPicture(const SpecimensReport& report) {
  return std::ranges::any_of(report.comparisons,
                             [](const SpecimenComparison& one) { return one.effects.has_value(); });
}

std::filesystem::path DrawSpecimens(const SpecimensReport& report, const std::filesystem::path& stem) {
  std::vector<const SpecimenComparison*> drawn;
  for (const SpecimenComparison& comparison : report.comparisons)
    if (comparison.effects) drawn.push_back(&comparison);
  const std::size_t rows = report.specimens.size();
  const PanelLayout layout =
      StackPanels(drawn.size(), kRow_px * static_cast<double>(rows + 1), kGapAbovePanel_px);
  std::size_t longest_name = 0;
  for (const DiagnosedSpecimenReport& specimen : report.specimens)
    longest_name = std::max(longest_name, specimen.name.size());
  std::string data;
  std::string script = CommonStyle() +
                       TitleLabel(fmt::format("{} specimens: what they share", rows), layout.height_px) +
                       "set multiplot\n" + MarginsBesideNames(longest_name, kForest_px, layout.height_px) +
                       fmt::format("set ytics ({}) scale 0\nunset key\n", RowNames(report));
  for (std::size_t panel = 0; panel < drawn.size(); ++panel) {
    const SpecimenComparison& comparison = *drawn[panel];
    const auto amount = std::ranges::find_if(
        comparison.sizes, [](const SpecimenSize& size) { return size.amount.has_value(); });
    std::vector<LegendEntry> legend{
        {"#222222", comparison.name + ": " + BelongingText(comparison.belonging), false},
        {kFirstColour.plain, comparison.phases ? "along the mean's phase" : "size"}};
    if (comparison.phases) legend.push_back({kLastColour.plain, "across it"});
    legend.push_back({"#444444", "bars: 95 %; band: mean ± sd between specimens", false});
    script += Legend(legend, layout.panels[panel], layout.height_px) + PanelMargins(layout.panels[panel]) +
              fmt::format("set xlabel {} offset 0,0.4\n", Quoted(amount->amount->name)) +
              PlotOf(MarksOf(comparison), panel, rows, data) + "unset label 1000\n";
  }
  return RenderPicture(data + script + "unset multiplot\n", stem,
                       {.width_px = kForest_px, .height_px = static_cast<int>(layout.height_px)});
}

}  // namespace strainwave::bench
