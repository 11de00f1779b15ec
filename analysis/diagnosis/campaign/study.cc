// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/campaign/causes.h"
#include "analysis/diagnosis/campaign/results.h"
#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr double kHours1000_s = 3.6e6;

// The wear model of each series: what it is at the start, its run-in, its trend, what accelerates late.
void AddWear(const LayoutPointer& layout, SeparableModel& model) {
  for (std::size_t s = 0; s < layout->series.size(); ++s) {
    const SeriesChoice one{{s}, true};
    SeparableTerm term =
        SeriesTerm(layout, one, 4, [layout](std::span<const double>, Eigen::MatrixXd& course) {
          course = WearColumns(layout->load_share, layout->run_in_share);
        });
    DescribeSeries(term, layout, one,
                   {{.what = "", .per = "", .unit_per = "", .factor = 1.0},
                    {.what = "trend",
                     .per = "per_1000h",
                     .unit_per = "/(1000 h)",
                     .factor = kHours1000_s / layout->load_span_s},
                    {.what = "late", .per = "", .unit_per = "", .factor = 1.0},
                    {.what = "run_in", .per = "", .unit_per = "", .factor = 1.0}},
                   {});
    model.nominal.push_back(std::move(term));
  }
}

void AddRegressor(const CampaignLayout& layout, const std::vector<double>& by_cycle, std::string name,
                  std::string title, double per_unit, SeparableModel& model) {
  if (by_cycle.empty()) return;
  Regressor regressor{std::move(name), std::move(title), per_unit, {}, false};
  for (const std::size_t c : layout.cycle_of) regressor.values.push_back(by_cycle[c]);
  model.regressors.push_back(std::move(regressor));
}

// Mean over the last cycles of each series, in its own unit: what a life test ends with.
std::vector<UserQuantity> LastResults(const CampaignLayout& layout, const Eigen::VectorXd& predicted) {
  constexpr std::size_t kLast = 5;
  std::vector<UserQuantity> quantities;
  for (const SeriesName& name : layout.series) quantities.push_back({"last_" + name.full, 0.0, 0.0});
  std::vector<double> count(layout.series.size(), 0.0);
  Eigen::MatrixXd responses(predicted.size(), 2);
  responses << Eigen::Map<const Eigen::VectorXd>(layout.measured.data(), predicted.size()), predicted;
  const Eigen::MatrixXd results = InTheirUnits(layout, responses);
  const std::size_t first = layout.cycles() - std::min(kLast, layout.cycles());
  for (std::size_t i = 0; i < layout.cycle_of.size(); ++i) {
    if (layout.cycle_of[i] < first) continue;
    const std::size_t s = layout.mixed_of[i];
    quantities[s].measured += results(static_cast<Index>(i), 0);
    quantities[s].predicted += results(static_cast<Index>(i), 1);
    count[s] += 1.0;
  }
  for (std::size_t s = 0; s < quantities.size(); ++s) {
    quantities[s].measured /= std::max(1.0, count[s]);
    quantities[s].predicted /= std::max(1.0, count[s]);
  }
  return quantities;
}

}  // namespace

std::unique_ptr<Study> MakeCampaignStudy(const CampaignData& campaign) {
  const auto layout = std::make_shared<const CampaignLayout>(LayOut(campaign));
  SeparableModel model;
  model.measured = layout->measured;
  model.segments = layout->segments;
  model.unit = "standard deviations";
  model.noise_floor = layout->noise_floor;
  // Cycles scatter independently: a few of them are a block, few enough to leave the run-in its own.
  model.block_length = std::max<std::size_t>(3, layout->cycles() / 60);
  model.largest_noise_order = 2;
  model.warnings = layout->warnings;
  AddWear(layout, model);
  AddStepChange(layout, model);
  AddSlopeChange(layout, model);
  AddDailyTemperature(layout, model);
  AddSensorReplaced(layout, model);
  AddPauseRecovery(layout, model);
  AddCampaignNuisanceTerms(layout, model);
  AddRegressor(*layout, layout->cycle, "cycle", "cycle", 1.0, model);
  AddRegressor(*layout, layout->load_time_s, "load_time", "credited load time / h", 1.0 / 3600.0, model);
  AddRegressor(*layout, layout->time_s, "time", "time / d", 1.0 / 86400.0, model);
  AddRegressor(*layout, layout->temperature_degC, "temperature", "temperature / degC", 1.0, model);
  model.quantities = [layout](const Eigen::VectorXd& predicted) { return LastResults(*layout, predicted); };
  return std::make_unique<SeparableStudy>(std::move(model));
}

}  // namespace strainwave::analysis::diagnosis
