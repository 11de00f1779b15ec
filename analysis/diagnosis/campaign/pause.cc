// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "analysis/diagnosis/campaign/causes.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {

namespace {

using Eigen::Index;

}  // namespace

void AddPauseRecovery(const LayoutPointer& layout, SeparableModel& model) {
  if (layout->time_s.empty()) return;
  std::vector<double> gaps;
  for (std::size_t c = 1; c < layout->cycles(); ++c)
    gaps.push_back(layout->time_s[c] - layout->time_s[c - 1]);
  const double longest_usual = 4.0 * Median(gaps) + 3600.0;
  std::vector<std::size_t> resumed;
  for (std::size_t c = 1; c < layout->cycles(); ++c) {
    if (gaps[c - 1] > longest_usual) resumed.push_back(c);
  }
  if (resumed.empty()) return;
  const SeriesNumber size{.what = "first_after_pause", .per = "", .unit_per = "", .factor = 1.0};
  const NonlinearParameterRange range{0.3, 30.0, 0.5};
  for (const SeriesChoice& choice : ChoicesOf(*layout)) {
    SeparableTerm term = SeriesTerm(
        layout, choice, 1, [resumed](std::span<const double> nonlinear_parameters, Eigen::MatrixXd& course) {
          course.setZero();
          for (const std::size_t from : resumed) {
            for (auto c = static_cast<Index>(from); c < course.rows(); ++c) {
              course(c, 0) =
                  std::exp(-static_cast<double>(c - static_cast<Index>(from)) / nonlinear_parameters[0]);
            }
          }
        });
    term.nonlinear_parameters = {range};
    DescribeSeries(term, layout, choice, {size}, {{"recovery_cycles", "1", 1.0, false}});
    term.starts = [layout, term](const WeightedResidual& residual) {
      return BestCandidates(*layout, term, residual, {{0.5}, {1.5}, {4.0}, {12.0}}, 2);
    };
    CauseRule rule{.name = "pause_recovery",
                   .what_to_do = "leave the first cycles after a pause out of trends",
                   .sentence = "the first cycles after a long pause differ" + choice.Suffix(*layout) +
                               " and come back: the gear had cooled, or its grease had settled",
                   .where = Where::kUndecided,
                   .effect = "E10",
                   .degrees_of_freedom = static_cast<int>(choice.series.size()) + 1,
                   .trials_factor = choice.TrialsFactor(*layout, 2.0),
                   .local = true,
                   .to_settle =
                       "# a longer warm-up before the first measurement after a pause: cold grease and a "
                       "cold gear are over by then\n"
                       "- kind: load_run\n  duration: 60 min\n  output_torque: 40 Nm\n"
                       "  input_speed: 2400 rpm\n"};
    AddSizeRules(*layout, choice, size, rule);
    rule.parameters.push_back({"recovery_cycles", "1", 0.0, 29.9, false});
    model.causes.push_back(std::move(term));
    model.rules.push_back(std::move(rule));
  }
}

}  // namespace strainwave::analysis::diagnosis
