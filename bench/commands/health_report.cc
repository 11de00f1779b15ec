// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/health_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/commands/output.h"

namespace strainwave::bench {
namespace {

namespace health = analysis::health;

double Cut(double value) { return std::clamp(value, 0.0, 1.0); }

void PrintVariance(const analysis::statistics::VarianceTable& table, const char* of) {
  ToStdout("\nanalysis of variance of {} ({})\n  {:<16} {:>12} {:>4} {:>9} {:>9} {:>7} {:>8}\n", of,
           NameOf(table.type), "source", "sum of sq.", "df", "F", "p", "eta²", "partial");
  for (const auto& row : table.rows) {
    ToStdout("  {:<16} {:>12.5g} {:>4}", row.source, row.sum_of_squares, row.degrees_of_freedom);
    if (std::isfinite(row.f))
      ToStdout(" {:>9.4g} {:>9.2g} {:>7.3f} {:>8.3f} [{:.3f}, {:.3f}]", row.f, row.p, row.eta_squared,
               row.partial_eta_squared, row.partial_low, row.partial_high);
    ToStdout("\n");
  }
  for (const std::string& note : table.notes) ToStdout("  note: {}\n", note);
}

std::string BandText(const HealthData& data, const std::string& feature) {
  const std::size_t first = feature.find('.');
  const std::size_t second = feature.find('.', first + 1);
  const std::string path = feature.substr(first + 1, second - first - 1);
  for (const auto& band : analysis::features::PacketBands(data.recipe.levels, data.sample_rate_hz)) {
    if (band.path == path)
      return fmt::format("W{}, {:g} to {:g} Hz", band.by_frequency, band.low_hz, band.high_hz);
  }
  return "";
}

}  // namespace

void PrintHealthTraining(const HealthData& data, const HealthJob& job, const HealthOutcome& outcome) {
  ToStdout("{} records, {} cycles of {} to {} rows at {:g} Hz ({}), {} conditions, {} units\n",
           data.files.size(), data.samples.size(), data.shortest, data.longest, data.sample_rate_hz, data.cut,
           data.conditions.rows(), data.units.size());
  for (std::size_t c = 0; c < data.components.size(); ++c) {
    const health::Selection& selection = outcome.chosen.of_component[c];
    ToStdout("\n{}: threshold {:.2f} ({} features above), kept\n", data.components[c],
             selection.threshold.threshold, selection.above.size());
    for (const Eigen::Index feature : selection.kept) {
      const std::string& name = data.samples.inputs[static_cast<std::size_t>(feature)];
      ToStdout("  {:<42} score {:.3f}   {}\n", name, outcome.chosen.scores[c].score(feature),
               BandText(data, name));
    }
  }
  ToStdout("\nhidden nodes: {}{}\n\nroot mean square error of the health, 0 to 1\n  {:<20}",
           outcome.hidden_nodes, outcome.trials.empty() ? "" : " (by cross-validation)", "");
  for (const std::string& name : data.components) ToStdout(" {:>9}", name);
  ToStdout("\n");
  for (const HealthSplit& split : outcome.splits) {
    ToStdout("  {:<20}", split.name);
    for (const double value : split.rmse) ToStdout(" {:>9.4f}", value);
    ToStdout("   {}\n  {:<20}", split.meaning, "  ridge");
    for (const double value : split.ridge_rmse) ToStdout(" {:>9.4f}", value);
    ToStdout("\n  {:<20}", "  always the mean");
    for (const double value : split.mean_rmse) ToStdout(" {:>9.4f}", value);
    ToStdout("\n");
  }
  ToStdout("intervals hold {:.0f} % of cycles of units and conditions that were left out\n",
           100.0 * job.coverage);
  if (outcome.variance.recordings) PrintVariance(*outcome.variance.recordings, "system_rms");
  if (outcome.variance.units)
    PrintVariance(*outcome.variance.units,
                  "the means of units: what recordings of one unit share is no error");
  if (outcome.system) {
    const SystemModel& system = *outcome.system;
    const auto& parameters = system.surface.parameters();
    ToStdout("\nsurface of system_rms over health: Gaussian process of {} measurements\n",
             system.measurements);
    ToStdout("  length {:.4g} (of health, 0 to 1{})\n", fmt::join(parameters.length, ", "),
             system.one_length ? "; one for all components" : "; one a component");
    ToStdout("  signal: variance {:.4g}, deviation {:.4g} in the unit of system_rms\n",
             parameters.signal_variance, std::sqrt(parameters.signal_variance));
    ToStdout("  noise of one measurement: variance {:.4g}, deviation {:.4g} in the unit of system_rms\n",
             parameters.noise_variance, std::sqrt(parameters.noise_variance));
    ToStdout("  log likelihood {:.4f} (one length {:.4f}, a length a component {:.4f})\n",
             system.surface.log_likelihood(), system.one_length_log_likelihood,
             system.own_lengths_log_likelihood);
    ToStdout("  index 0: {:.5g}, {}; index 1: {:.5g}, {}\n", system.scale.healthy, system.healthy_is,
             system.scale.limit, system.limit_is);
  }
  for (const std::string& note : outcome.notes) ToStdout("note: {}\n", note);
}

void PrintAssessment(const HealthModel& model, const HealthAssessment& assessment) {
  ToStdout("{} ({} cycles)\n", assessment.file, assessment.cycles);
  for (std::size_t c = 0; c < model.components.size(); ++c) {
    const health::Bounded& one = assessment.health[c];
    ToStdout("  {:<12} {:.2f}  [{:.2f}, {:.2f}]\n", model.components[c], Cut(one.value), Cut(one.low),
             Cut(one.high));
  }
  if (assessment.system)
    ToStdout("  {:<12} {:.2f}  [{:.2f}, {:.2f}]\n", "system", assessment.system->value,
             assessment.system->low, assessment.system->high);
  if (assessment.outside_training)
    ToStdout("  outside what was trained on ({:.1f} times the limit): not valid\n", assessment.distance);
  if (assessment.extrapolated)
    ToStdout("  the system's index is extrapolated: no such condition was measured\n");
  if (assessment.near_failed_condition) ToStdout("  near a condition in which the system failed\n");
}

void PrintWhatIf(const HealthModel& model, const Eigen::VectorXd& state, const health::WhatIf& answer,
                 const std::string& interval) {
  const auto text = [](const health::Bounded& b) {
    return fmt::format("{:6.3f}  [{:.3f}, {:.3f}]", b.value, b.low, b.high);
  };
  const auto mark = [](const health::SystemAt& at) { return at.extrapolated ? "  extrapolated" : ""; };
  ToStdout("system now {}{}\n  (0: as new, 1: its limit; 95 % intervals of {})\n", text(answer.system.index),
           mark(answer.system), interval == "mean" ? "the mean" : "a new measurement");
  ToStdout("\nwith one component replaced\n");
  for (std::size_t place = 0; place < answer.ranking.size(); ++place) {
    const std::size_t c = answer.ranking[place];
    ToStdout(
        "  {:<12} {}{}   restores {:.3f}{}\n", model.components[c], text(answer.restored[c].index),
        mark(answer.restored[c]), answer.gain[c].value,
        place < answer.tied_with_next.size() && answer.tied_with_next[place] ? "   a tie with the next" : "");
  }
  ToStdout("\nwhere it comes from (intervals of the mean)\n  {:<12} {:<28} {}\n", "", "Shapley", "alone");
  for (std::size_t c = 0; c < model.components.size(); ++c)
    ToStdout("  {:<12} {:<28} {}   at {:.2f}\n", model.components[c], text(answer.shapley[c]),
             text(answer.alone[c]), state(static_cast<Eigen::Index>(c)));
  ToStdout("  {:<12} {:<28} {}\n", "interaction", "(shared)", text(answer.interaction));
  ToStdout("  {:<12} {}{}   what no component explains\n", "baseline", text(answer.baseline.index),
           mark(answer.baseline));
  if (NearFailedCondition(model, state))
    ToStdout(
        "this state is nearer to a condition in which the system failed than to any that was measured\n");
}

}  // namespace strainwave::bench
