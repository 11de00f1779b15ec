// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/fault_report.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/commands/output.h"

namespace strainwave::bench {
namespace {

namespace faults = analysis::faults;

std::string PercentText(std::optional<double> share) {
  return share ? fmt::format("{:.1f}", 100.0 * *share) : "-";
}

void PrintSplits(const FaultOutcome& outcome) {
  const bool labels = outcome.model.labels;
  ToStdout("\n{:<22} {:>8}", labels ? "all faults right, %" : "accuracy, %", "records");
  for (const FaultTableResult& table : outcome.tables) ToStdout(" {:>16}", NameOf(table.set));
  ToStdout(" {:>14} {:>16}\n", "undecided, %", labels ? "labels wrong, %" : "of decided, %");
  for (std::size_t k = 0; k < outcome.splits.size(); ++k) {
    const FaultSplitResult& chosen = outcome.tables[outcome.chosen].splits[k];
    ToStdout("  {:<20} {:>8}", outcome.splits[k].name, chosen.Tested());
    for (const FaultTableResult& table : outcome.tables)
      ToStdout(" {:>16}", PercentText(table.splits[k].Accuracy()));
    const auto tested = static_cast<double>(chosen.Tested());
    if (chosen.classes)
      ToStdout(" {:>14.1f} {:>16.1f}", 100.0 * static_cast<double>(chosen.classes->undecided) / tested,
               100.0 * chosen.classes->decided_accuracy);
    if (chosen.labels)
      ToStdout(" {:>14.1f} {:>16.1f}", 100.0 * static_cast<double>(chosen.labels->undecided) / tested,
               100.0 * chosen.labels->one_wrong);
    ToStdout("\n");
  }
  if (outcome.tables.size() > 1)
    ToStdout("taken: {}, the better one over the splits that leave whole groups out\n",
             NameOf(outcome.tables[outcome.chosen].set));
}

void PrintCompared(const std::string& name, const FaultTableResult& result) {
  ToStdout("  {:<20}", name);
  for (const FaultSplitResult& split : result.splits) ToStdout(" {:>16}", PercentText(split.Accuracy()));
  ToStdout("\n");
}

void PrintComparisons(const FaultOutcome& outcome) {
  if (outcome.by_levels.empty()) return;
  ToStdout("\n{:<22}", "accuracy, %");
  for (const FaultSplit& split : outcome.splits) ToStdout(" {:>16}", split.name);
  ToStdout("\n");
  for (std::size_t k = 0; k < outcome.by_levels.size(); ++k)
    PrintCompared(fmt::format("D1 to D{}", k + 1), outcome.by_levels[k]);
  for (const auto& [wavelet, result] : outcome.by_wavelet) PrintCompared(wavelet, result);
}

void PrintFaultConfusion(const std::string& split, const Eigen::MatrixXi& confusion,
                         const std::vector<std::string>& classes) {
  ToStdout("\n{}: own class (row), told as\n  {:<24}", split, "");
  for (std::size_t k = 0; k < classes.size(); ++k) ToStdout(" {:>6}", fmt::format("({})", k + 1));
  ToStdout("\n");
  for (Eigen::Index own = 0; own < confusion.rows(); ++own) {
    ToStdout("  {:<24}", fmt::format("({}) {}", own + 1, classes[static_cast<std::size_t>(own)]));
    for (Eigen::Index told = 0; told < confusion.cols(); ++told) ToStdout(" {:>6}", confusion(own, told));
    ToStdout("\n");
  }
}

void PrintLabels(const std::string& split, const faults::LabelScores& scores,
                 const std::vector<std::string>& names) {
  ToStdout("\n{}: {:<20} {:>8} {:>8} {:>8} {:>8} {:>8}\n", split, "fault", "told", "missed", "false", "right",
           "F1");
  for (std::size_t k = 0; k < names.size(); ++k) {
    const faults::LabelCounts& counts = scores.labels[k];
    ToStdout("  {:<28} {:>8} {:>8} {:>8} {:>8} {:>8.3f}\n", names[k], counts.present_told,
             counts.present_missed, counts.absent_told, counts.absent_not_told, counts.F1());
  }
}

}  // namespace

void PrintFaultTraining(const FaultRecords& records, const FaultOutcome& outcome) {
  const std::set<std::string> units(records.labels.unit.begin(), records.labels.unit.end());
  const auto& details = records.tables.front().settings.details;
  ToStdout("{} records of {} units at {:g} Hz, channels {}\n{}: {}\n", records.files.size(), units.size(),
           records.sample_rate_hz, fmt::join(records.channels, ", "),
           records.labels.labels ? "faults, of which several may be there" : "classes",
           fmt::join(records.labels.outputs, ", "));
  ToStdout("details D1 to D{} of {}, from {:.4g} Hz down to {:.3g} Hz\n", details.levels, details.wavelet,
           0.5 * records.sample_rate_hz,
           0.5 * records.sample_rate_hz / static_cast<double>(1LL << static_cast<unsigned>(details.levels)));
  PrintSplits(outcome);
  const analysis::faults::UndecidedRule& rule = outcome.model.rule;
  if (records.labels.labels) {
    ToStdout("undecided: a probability within {:g} of its threshold, or outside what was trained on\n",
             0.5 * rule.least_margin);
  } else {
    ToStdout(
        "undecided: no class of probability {:g} or more, the first two less than {:g} apart, or outside "
        "what was trained on\n",
        rule.least_probability, rule.least_margin);
  }
  PrintComparisons(outcome);
  for (const FaultSplit& split : outcome.splits) {
    const auto place = static_cast<std::size_t>(&split - outcome.splits.data());
    const FaultSplitResult& result = outcome.tables[outcome.chosen].splits[place];
    if (result.classes) PrintFaultConfusion(split.name, result.classes->confusion, records.labels.outputs);
    if (result.labels) PrintLabels(split.name, *result.labels, records.labels.outputs);
  }
  if (!outcome.limits.empty() || !records.notes.empty()) ToStdout("\n");
  for (const std::string& limit : outcome.limits) ToStdout("limit: {}\n", limit);
  constexpr std::size_t kMostNotes = 10;
  for (std::size_t i = 0; i < std::min(kMostNotes, records.notes.size()); ++i)
    ToStdout("note: {}\n", records.notes[i]);
  if (records.notes.size() > kMostNotes)
    ToStdout("note: and {} more, all in faults.json\n", records.notes.size() - kMostNotes);
}

void PrintFaultVerdict(const FaultModel& model, const FaultVerdict& verdict) {
  ToStdout("{}{}{}: {}{}\n", verdict.file, verdict.group.empty() ? "" : " ", verdict.group,
           verdict.undecided ? "undecided, nearest " : "", verdict.name);
  for (std::size_t k = 0; k < verdict.probability.size(); ++k)
    ToStdout("  {:<28} {:>7.3f}\n", model.predictor.outputs[k], verdict.probability[k]);
  if (!verdict.why.empty()) ToStdout("  {}\n", verdict.why);
  for (const BearingSign& sign : verdict.bearing)
    ToStdout("  bearing: {:<11} {:>7.3f} a turn, {:>8.2f} Hz: {}\n", sign.part, sign.order, sign.frequency_Hz,
             std::isfinite(sign.prominence_dB)
                 ? fmt::format("{:>5.1f} dB over its neighbours", sign.prominence_dB)
                 : std::string("not told from its neighbours"));
}

}  // namespace strainwave::bench
