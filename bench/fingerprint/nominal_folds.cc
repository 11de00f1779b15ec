// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/nominal_folds.h"

#include <algorithm>
#include <mutex>
#include <set>

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;
using Files = std::vector<std::size_t>;

// Whose fingerprints, of which fold of which split, a network makes.
struct Use {
  std::string split;
  std::size_t fold;
  std::size_t file;
};
// By the healthy files that the network learns from.
using Jobs = std::map<Files, std::vector<Use>>;

Files Without(const Files& files, const std::vector<int>& fold, int one, int other) {
  Files left;
  for (const std::size_t f : files) {
    if (fold[f] != one && fold[f] != other) left.push_back(f);
  }
  return left;
}

Files Healthy(const Files& files, const dynamics::FileFacts& facts) {
  Files healthy;
  for (const std::size_t f : files) {
    if (facts.faulty[f] == 0) healthy.push_back(f);
  }
  return healthy;
}

class JobList {
 public:
  explicit JobList(const dynamics::FileFacts& facts) : facts_(facts) {
    for (std::size_t f = 0; f < facts.files(); ++f) all_.push_back(f);
  }

  // @return false where a network would have nothing to learn from.
  bool Add(const dynamics::FileSplit& split) {
    Jobs jobs;
    bool possible = true;
    const auto add = [&](const Files& from, int fold, const Files& made) {
      const Files healthy = Healthy(from, facts_);
      possible = possible && !healthy.empty();
      for (const std::size_t f : made)
        jobs[healthy].push_back({split.name, static_cast<std::size_t>(fold), f});
    };
    if (split.by_samples) {
      add(all_, 0, all_);
    } else {
      for (int k = 0; k < split.folds; ++k) {
        const Files outside = Without(all_, split.fold, k, k);
        add(outside, k, InFold(split, k));
        for (const auto& [from, made] : Inner(split, k, outside)) add(from, k, made);
      }
    }
    if (possible) {
      for (const auto& [healthy, uses] : jobs)
        jobs_[healthy].insert(jobs_[healthy].end(), uses.begin(), uses.end());
    }
    return possible;
  }

  const Jobs& jobs() const { return jobs_; }
  Files AllHealthy() const { return Healthy(all_, facts_); }

 private:
  static Files InFold(const dynamics::FileSplit& split, int k) {
    Files files;
    for (std::size_t f = 0; f < split.fold.size(); ++f) {
      if (split.fold[f] == k) files.push_back(f);
    }
    return files;
  }

  // What networks for the files outside of fold k learn from, and which files they are for.
  std::vector<std::pair<Files, Files>> Inner(const dynamics::FileSplit& split, int k,
                                             const Files& outside) const {
    std::vector<std::pair<Files, Files>> parts;
    constexpr int kFewestForPairs = 4;
    if (split.folds >= kFewestForPairs) {
      for (int j = 0; j < split.folds; ++j) {
        if (j != k) parts.emplace_back(Without(all_, split.fold, j, k), InFold(split, j));
      }
      return parts;
    }
    dynamics::FileFacts within;
    for (const std::size_t f : outside) {
      within.faulty.push_back(facts_.faulty[f]);
      within.unit.push_back(facts_.unit[f]);
      within.origin.push_back(facts_.origin[f]);
    }
    constexpr int kInnerFolds = 3;
    for (const dynamics::FileSplit& inner : dynamics::SplitsOfFiles(within, kInnerFolds, 1)) {
      if (inner.name != dynamics::kUnitSplit) continue;
      for (int i = 0; i < inner.folds; ++i) {
        Files from;
        Files made;
        for (std::size_t n = 0; n < inner.fold.size(); ++n)
          (inner.fold[n] == i ? made : from).push_back(outside[n]);
        parts.emplace_back(from, made);
      }
    }
    if (parts.empty()) parts.emplace_back(outside, outside);  // one unit alone
    return parts;
  }

  const dynamics::FileFacts& facts_;
  Files all_;
  Jobs jobs_;
};

dynamics::JointMotion TrainingRows(const std::vector<dynamics::JointMotion>& motion, const Files& files,
                                   const NominalSettings& settings, std::vector<int>& part) {
  std::vector<dynamics::JointMotion> parts;
  const auto rows = std::clamp(settings.rows_of_file * static_cast<Eigen::Index>(files.size()),
                               settings.fewest_rows, settings.most_rows);
  for (const std::size_t f : files) {
    const auto each =
        std::max<Eigen::Index>(dynamics::kFewestRows, rows / static_cast<Eigen::Index>(files.size()));
    parts.push_back(dynamics::RowsOf(motion[f], dynamics::EvenRows(motion[f].size(), each)));
    part.insert(part.end(), static_cast<std::size_t>(parts.back().size()), static_cast<int>(f));
  }
  return dynamics::Stacked(parts);
}

}  // namespace

Eigen::MatrixXd BackgroundOf(const std::vector<dynamics::JointMotion>& motion, const Files& files,
                             Eigen::Index rows) {
  std::vector<dynamics::JointMotion> parts;
  const auto each = std::max<Eigen::Index>(1, rows / static_cast<Eigen::Index>(files.size()));
  for (const std::size_t f : files) {
    // Not from the first row on: records often begin at rest.
    const std::vector<Eigen::Index> inner = dynamics::EvenRows(motion[f].size(), 2 * each + 1);
    std::vector<Eigen::Index> chosen;
    for (std::size_t i = 1; i < inner.size(); i += 2) chosen.push_back(inner[i]);
    parts.push_back(dynamics::RowsOf(motion[f], chosen));
  }
  return dynamics::Stacked(parts).states;
}

NominalFolds MakeNominalFolds(const std::vector<dynamics::FileSplit>& splits,
                              const dynamics::FileFacts& facts,
                              const std::vector<dynamics::JointMotion>& motion,
                              const std::vector<dynamics::JointMotion>& samples,
                              const NominalSettings& settings, const analysis::ParallelFor& parallel,
                              const std::function<void(double share)>& progress) {
  NominalFolds result;
  JobList list(facts);
  std::vector<Eigen::Index> begin{0};
  for (const dynamics::JointMotion& of_file : samples) begin.push_back(begin.back() + of_file.size());
  const Eigen::Index columns = static_cast<Eigen::Index>(
      dynamics::NominalNames(settings.attribution.fingerprint, motion.front().joints()).size());
  for (const dynamics::FileSplit& split : splits) {
    if (!split.impossible.empty()) continue;
    if (!list.Add(split)) {
      result.impossible[split.name] =
          "with a fold left out, no healthy file is left to learn what is nominal from";
      continue;
    }
    const auto folds = static_cast<std::size_t>(split.by_samples ? 1 : split.folds);
    result.features[split.name].of_fold.assign(folds, Eigen::MatrixXd(begin.back(), columns));
  }
  const std::vector<std::pair<Files, std::vector<Use>>> jobs(list.jobs().begin(), list.jobs().end());
  const Files all_healthy = list.AllHealthy();
  std::mutex telling;
  std::size_t done = 0;
  parallel(jobs.size(), [&](std::size_t j) {
    const auto& [files, uses] = jobs[j];
    std::vector<int> part;
    const dynamics::JointMotion rows = TrainingRows(motion, files, settings, part);
    const analysis::prediction::Ensemble network = dynamics::TrainDynamics(rows, part, settings.training);
    const Eigen::MatrixXd background = BackgroundOf(motion, files, settings.background);
    std::map<std::size_t, Eigen::MatrixXd> made;
    double gap = 0.0;
    double error = 0.0;
    for (const Use& use : uses) {
      if (!made.contains(use.file)) {
        const dynamics::Attributions attributions =
            dynamics::Attribute(network, samples[use.file].states, background, settings.attribution);
        gap = std::max(gap, attributions.worst_gap);
        error = std::max(error, attributions.mean_standard_error);
        made[use.file] = dynamics::NominalFingerprints(network, samples[use.file], attributions.fingerprints);
      }
      result.features.at(use.split).of_fold[use.fold].middleRows(begin[use.file], samples[use.file].size()) =
          made[use.file];
    }
    const std::lock_guard lock(telling);
    result.worst_gap = std::max(result.worst_gap, gap);
    result.mean_standard_error = std::max(result.mean_standard_error, error);
    ++result.networks;
    if (files == all_healthy) {
      result.nominal.emplace(network);
      result.background = background;
    }
    progress(static_cast<double>(++done) / static_cast<double>(jobs.size()));
  });
  return result;
}

}  // namespace strainwave::bench
