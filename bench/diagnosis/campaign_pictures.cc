// SPDX-License-Identifier: Apache-2.0
// The diagnosis of a campaign, result by result in its own unit.
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/diagnosis/campaign_results.h"
#include "analysis/diagnosis/residual_views.h"
#include "analysis/quantities.h"
#include "bench/diagnosis/diagnosis_pictures.h"
#include "bench/diagnosis/picture_frame.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using diagnosis::ResultSeries;

constexpr double kPanel_px = 190.0;
constexpr double kGap_px = 26.0;

// "k1_Nm_per_rad", "Nm/rad" → "K₁ (Nm/rad)"; "e_max_arcmin" → "e_max (arcmin)".
std::string LabelOf(const ResultSeries& series) {
  const analysis::Quantity* const quantity = analysis::FindQuantity(series.name);
  return fmt::format("{} ({})", quantity == nullptr ? analysis::WithoutUnit(series.name) : quantity->title,
                     series.unit);
}

// What was measured and what the models say, of the same results.
struct CampaignCurves {
  std::vector<ResultSeries> measured;
  std::vector<ResultSeries> nominal;
  std::vector<ResultSeries> extended;
};

CampaignCurves CurvesOf(const DiagnosisReport& report) {
  const diagnosis::CampaignData& campaign = *report.input.campaign;
  const std::span<const double> response = report.input.study->measured();
  const Eigen::Map<const Eigen::VectorXd> measured(response.data(),
                                                   static_cast<Eigen::Index>(response.size()));
  return {diagnosis::ResultsOf(campaign, measured),
          diagnosis::ResultsOf(campaign, report.result.nominal.predicted),
          diagnosis::ResultsOf(campaign, report.result.extended.predicted)};
}

std::vector<double> StandardErrors(const diagnosis::CampaignData& campaign, const ResultSeries& series) {
  const auto found = std::ranges::find(campaign.series, series.name, &diagnosis::CampaignSeries::name);
  std::vector<double> errors;
  for (const std::size_t row : series.row) {
    const bool known = found != campaign.series.end() && row < found->standard_error.size() &&
                       std::isfinite(found->standard_error[row]);
    errors.push_back(known ? found->standard_error[row] : 0.0);
  }
  return errors;
}

std::vector<double> Less(const std::vector<double>& values, const std::vector<double>& others) {
  std::vector<double> difference(values.size());
  std::ranges::transform(values, others, difference.begin(), std::minus<>());
  return difference;
}

// One panel a result, one above the other over a common axis; `plot` draws the k-th of them.
template <typename Plot>
std::filesystem::path DrawPanels(const DiagnosisReport& report, const CampaignCurves& curves,
                                 const std::string& title, const std::string& axis,
                                 const std::vector<LegendEntry>& legend, const std::filesystem::path& stem,
                                 const Plot& plot) {
  const PanelLayout layout = StackPanels(curves.measured.size(), kPanel_px, kGap_px);
  std::string data;
  std::string script = CommonStyle() + TitleLabel(TitleOf(report, title), layout.height_px) +
                       fmt::format("set multiplot\nset lmargin at screen {}\n", kPanelLeft) +
                       "set rmargin at screen 0.975\nunset key\nset offsets graph 0.02,graph 0.02,graph "
                       "0.08,graph 0.08\n";
  script += Legend(legend, layout.panels.front(), layout.height_px, 10.0);
  for (std::size_t k = 0; k < curves.measured.size(); ++k) {
    const bool lowest = k + 1 == curves.measured.size();
    script += PanelMargins(layout.panels[k]);
    script += fmt::format("set format x '{}'\nset xlabel {} offset 0,0.4\n", lowest ? "%g" : "",
                          lowest ? Quoted(axis) : "''");
    script += fmt::format("set ylabel {}\n", Quoted(LabelOf(curves.measured[k])));
    script += plot(k, data);
    script += "unset label\n";
  }
  return RenderPicture(data + script + "unset multiplot\n", stem,
                       {.width_px = 1200, .height_px = static_cast<int>(layout.height_px)});
}

std::vector<LegendEntry> ModelLegend(const DiagnosisReport& report) {
  std::vector<LegendEntry> legend{{kLastColour.plain, NominalName(report)}};
  if (IsExtended(report)) legend.push_back({kFirstColour.plain, ExtendedName(report)});
  return legend;
}

}  // namespace

std::filesystem::path DrawCampaignResults(const DiagnosisReport& report, const std::filesystem::path& stem) {
  const CampaignCurves curves = CurvesOf(report);
  std::vector<LegendEntry> legend = ModelLegend(report);
  legend.insert(legend.begin(), {kMeasuredColour, "measured, with its standard error"});
  return DrawPanels(
      report, curves, "measured and simulated", "cycle", legend, stem, [&](std::size_t k, std::string& data) {
        const ResultSeries& series = curves.measured[k];
        const std::vector<double> cycle = Picked(report.input.campaign->cycle, series.row);
        const std::vector<double> errors = StandardErrors(*report.input.campaign, series);
        data += DataBlock(fmt::format("result{}", k),
                          {cycle, series.value, errors, curves.nominal[k].value, curves.extended[k].value});
        std::string plot = fmt::format(
            "plot $result{0} using 1:2:3 with yerrorbars pointtype 7 pointsize {1} linecolor rgb '{2}',\\\n"
            "  $result{0} using 1:4 with lines linewidth 1.8 linecolor rgb '{3}'",
            k, DotSize(cycle.size()), kMeasuredColour, kLastColour.plain);
        if (IsExtended(report)) {
          plot += fmt::format(",\\\n  $result{} using 1:5 with lines linewidth 1.8 linecolor rgb '{}'", k,
                              kFirstColour.plain);
        }
        return plot + "\n";
      });
}

std::filesystem::path DrawCampaignResiduals(const DiagnosisReport& report, std::size_t regressor,
                                            const std::filesystem::path& stem) {
  const CampaignCurves curves = CurvesOf(report);
  const diagnosis::Regressor& over = report.input.study->regressors()[regressor];
  const std::string quantity = diagnosis::SplitTitle(over).quantity;
  return DrawPanels(
      report, curves, "measured less simulated, over " + quantity, AxisTitle(over.title), ModelLegend(report),
      stem, [&](std::size_t k, std::string& data) {
        const ResultSeries& series = curves.measured[k];
        const std::vector<double> place = Picked(over.values, series.sample, over.per_unit);
        const std::vector<double> errors = StandardErrors(*report.input.campaign, series);
        data += DataBlock(fmt::format("missed{}", k), {place, Less(series.value, curves.nominal[k].value),
                                                       errors, Less(series.value, curves.extended[k].value)});
        const auto dots = [&](int column, int shape, std::string_view colour) {
          return fmt::format(
              "$missed{} using 1:{}:3 with yerrorbars pointtype {} pointsize {} linecolor rgb '{}'", k,
              column, shape, DotSize(place.size()), colour);
        };
        std::string plot =
            "plot 0 with lines linewidth 0.8 linecolor rgb '#AAAAAA',\\\n  " + dots(2, 6, kLastColour.plain);
        if (IsExtended(report)) plot += ",\\\n  " + dots(4, 7, kFirstColour.plain);
        return plot + "\n";
      });
}

}  // namespace strainwave::bench
