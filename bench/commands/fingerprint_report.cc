// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/fingerprint_report.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "bench/commands/output.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;
namespace prediction = analysis::prediction;

void PrintScores(const char* title, const FingerprintOutcome& outcome, const dynamics::ScoreTable& table,
                 const std::vector<std::string>& kinds) {
  ToStdout("\n{}\n  {:<20}", title, "");
  for (const dynamics::FileSplit& split : outcome.splits) ToStdout(" {:>26}", split.name);
  ToStdout("\n");
  for (const std::string& kind : kinds) {
    ToStdout("  {:<20}", kind);
    for (const dynamics::FileSplit& split : outcome.splits) {
      const auto found = table.find(split.name);
      if (found == table.end()) {
        ToStdout(" {:>26}", "none");
        continue;
      }
      const dynamics::SplitScore& score = found->second.at(kind);
      ToStdout(" {:>26}", fmt::format("{:.3f} ({:.2f}-{:.2f}) {:.3f}", score.accuracy, score.low, score.high,
                                      score.area_under_curve));
    }
    ToStdout("\n");
  }
}

}  // namespace

void PrintFingerprintTraining(const FingerprintData& data, const FingerprintOutcome& outcome) {
  const std::set<int> units(data.facts.unit.begin(), data.facts.unit.end());
  const auto faulty = std::accumulate(data.facts.faulty.begin(), data.facts.faulty.end(), 0);
  ToStdout("{} files of {} units with {} joints, {} of them faulty (all but class '{}')\n", data.files.size(),
           units.size(), data.joints(), faulty, data.healthy);
  const JointFile& first = data.files.front();
  ToStdout("filter: {} samples, order {}, a low-pass of {:.1f} Hz at {:g} Hz; accelerations {}\n",
           first.window, data.smoothing.order, first.half_power_hz, first.sample_rate_hz,
           data.acceleration_measured ? "as measured" : "from the velocities");
  double worst = 1.0;
  double sum = 0.0;
  for (const FileDynamics& own : outcome.dynamics) {
    worst = std::min(worst, own.held_out.explained_share.minCoeff());
    sum += own.trained.mse_Nm2;
  }
  ToStdout(
      "each file's own network: mean squared error {:.3g} Nm² on what it learnt; of the last tenth, which it "
      "has "
      "not seen, it explains a share of {:.2f} or more\n",
      sum / static_cast<double>(outcome.dynamics.size()), worst);
  const FingerprintModel& model = *outcome.model;
  ToStdout(
      "fingerprint '{}' by the method '{}' from {} background rows of healthy files; attributions sum to "
      "what "
      "they explain within {:.1e}\n",
      dynamics::NameOf(model.attribution.fingerprint), dynamics::NameOf(model.attribution.method),
      outcome.background_rows, outcome.worst_gap);
  for (const BackgroundRanking& ranking : outcome.rankings) {
    ToStdout("  joints by importance from the background {:<8}", ranking.name);
    for (const int joint : ranking.order) ToStdout(" {}", joint);
    ToStdout("   rank correlation {:.2f}\n", ranking.rank_correlation);
  }
  ToStdout(
      "\naccuracy (95 % interval) and area under the curve. random: samples of one file on both sides, as "
      "published, which flatters;\nthe others count files, each judged by what has seen nothing of it\n");
  std::vector<std::string> kinds;
  for (const prediction::BinaryKind kind : prediction::kBinaryKinds)
    kinds.emplace_back(prediction::NameOf(kind));
  PrintScores("raw signals", outcome, outcome.raw, kinds);
  PrintScores("fingerprints by nominal networks of healthy units (those that the model uses)", outcome,
              outcome.nominal, kinds);
  PrintScores("friction above that of healthy files by these networks, told without a faulty file", outcome,
              outcome.excess_friction, {dynamics::kExcessFriction});
  PrintScores("fingerprints by each file's own network, as published", outcome, outcome.per_file, kinds);
  PrintScores("the same with labels dealt anew among files: what is left is the files' identity", outcome,
              outcome.shuffled, {std::string(prediction::NameOf(prediction::BinaryKind::kForest))});
  for (const auto& [split, why] : outcome.impossible) ToStdout("no {}: {}\n", split, why);
}

void PrintVerdict(const FileVerdict& verdict, const FingerprintModel& model) {
  ToStdout("{}: {} ({:.3f} that it has a fault)\n", verdict.file.string(),
           verdict.probability > 0.5 ? "faulty" : model.healthy, verdict.probability);
  for (std::size_t j = 0; j < verdict.attribution.size(); ++j)
    ToStdout("  joint {:<3} {:+.3f}   {:.3g} Nm not explained\n", j + 1, verdict.attribution[j],
             verdict.residual_Nm[j]);
}

std::vector<std::filesystem::path> JointRecordPaths(const std::vector<std::string>& paths) {
  std::vector<std::filesystem::path> files;
  for (const std::string& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      files.emplace_back(path);
      continue;
    }
    std::vector<std::filesystem::path> within;
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      const std::filesystem::path ending = entry.path().extension();
      if ((ending == ".csv" || ending == ".h5" || ending == ".hdf5") &&
          entry.path().filename() != "labels.csv")
        within.push_back(entry.path());
    }
    if (within.empty()) Refuse(path, "holds no records", "files that end in .csv, .h5 or .hdf5");
    std::ranges::sort(within);
    files.insert(files.end(), within.begin(), within.end());
  }
  return files;
}

}  // namespace strainwave::bench
