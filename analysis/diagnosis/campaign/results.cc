// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/campaign/results.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/campaign_results.h"

namespace strainwave::analysis::diagnosis {

using Eigen::Index;

Eigen::MatrixXd InTheirUnits(const CampaignLayout& layout, const Eigen::MatrixXd& responses) {
  std::vector<std::vector<Index>> samples_of(layout.cycles());
  for (std::size_t i = 0; i < layout.cycle_of.size(); ++i) {
    samples_of[layout.cycle_of[i]].push_back(static_cast<Index>(i));
  }
  Eigen::MatrixXd results(responses.rows(), responses.cols());
  for (const std::vector<Index>& samples : samples_of) {
    if (samples.empty()) continue;
    std::vector<Index> series;
    for (const Index sample : samples) {
      series.push_back(static_cast<Index>(layout.mixed_of[static_cast<std::size_t>(sample)]));
    }
    const Eigen::MatrixXd mixing = layout.mixing(samples, series);
    const Eigen::MatrixXd mixed = responses(samples, Eigen::all);
    const Eigen::MatrixXd values = SolveSquare(mixing, mixed);
    for (std::size_t k = 0; k < samples.size(); ++k) {
      results.row(samples[k]) =
          layout.scale[static_cast<std::size_t>(series[k])] * values.row(static_cast<Index>(k));
    }
  }
  return results;
}

std::vector<ResultSeries> ResultsOf(const CampaignData& campaign, const Eigen::VectorXd& response) {
  const CampaignLayout layout = LayOut(campaign);
  const Eigen::VectorXd values = InTheirUnits(layout, response);
  std::vector<ResultSeries> results;
  for (const SeriesName& name : layout.series) results.push_back({name.full, name.unit, {}, {}, {}});
  for (std::size_t i = 0; i < layout.cycle_of.size(); ++i) {
    ResultSeries& one = results[layout.mixed_of[i]];
    one.row.push_back(layout.cycle_of[i]);
    one.sample.push_back(i);
    one.value.push_back(values(static_cast<Index>(i)));
  }
  return results;
}

}  // namespace strainwave::analysis::diagnosis
