// SPDX-License-Identifier: Apache-2.0
#include "analysis/joint_dynamics/file_splits.h"

#include <algorithm>
#include <map>
#include <random>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/shuffle.h"

namespace strainwave::analysis::joint_dynamics {
namespace {

// Of groups that have healthy files, faulty ones, or both, the folds are dealt in turn.
std::map<int, int> FoldsOfGroups(const std::vector<int>& group, const std::vector<int>& faulty, int folds,
                                 std::uint64_t seed) {
  std::map<int, unsigned> classes;  // bit 0: healthy, bit 1: faulty
  for (std::size_t i = 0; i < group.size(); ++i) classes[group[i]] |= faulty[i] == 0 ? 1U : 2U;
  std::mt19937_64 random(seed);
  std::map<int, int> fold_of;
  int next = 0;
  for (const unsigned kind : {3U, 2U, 1U}) {
    std::vector<int> alike;
    for (const auto& [number, has] : classes) {
      if (has == kind) alike.push_back(number);
    }
    Shuffle(alike, random);
    for (const int number : alike) fold_of[number] = next++ % folds;
  }
  return fold_of;
}

std::string WhyNot(const FileSplit& split, const std::vector<int>& faulty) {
  for (int fold = 0; fold < split.folds; ++fold) {
    int healthy = 0;
    int with_fault = 0;
    for (std::size_t i = 0; i < faulty.size(); ++i) {
      if (split.fold[i] != fold) ++(faulty[i] == 0 ? healthy : with_fault);
    }
    if (healthy == 0 || with_fault == 0)
      return fmt::format("with fold {} of {} left out, no {} file is left to train on", fold + 1, split.folds,
                         healthy == 0 ? "healthy" : "faulty");
  }
  return {};
}

FileSplit SplitByGroup(std::string_view name, const std::vector<int>& group, const FileFacts& facts,
                       int folds, std::uint64_t seed) {
  FileSplit split{std::string(name), false, 0, {}, {}};
  std::vector<int> numbers = group;
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  split.folds = std::min(folds, static_cast<int>(numbers.size()));
  if (split.folds < 2) {
    split.impossible = "there is only one to leave out";
    return split;
  }
  const std::map<int, int> fold_of = FoldsOfGroups(group, facts.faulty, split.folds, seed);
  for (const int number : group) split.fold.push_back(fold_of.at(number));
  split.impossible = WhyNot(split, facts.faulty);
  return split;
}

}  // namespace

std::vector<FileSplit> SplitsOfFiles(const FileFacts& facts, int folds, std::uint64_t seed) {
  if (facts.files() == 0 || facts.unit.size() != facts.files() || facts.origin.size() != facts.files() ||
      folds < 2)
    throw std::invalid_argument("a class, a unit and an origin are needed of each file, and 2 folds or more");
  std::vector<int> each(facts.files());
  for (std::size_t i = 0; i < each.size(); ++i) each[i] = static_cast<int>(i);
  return {FileSplit{std::string(kRandomSplit), true, folds, {}, {}},
          SplitByGroup(kFileSplit, each, facts, folds, seed),
          SplitByGroup(kUnitSplit, facts.unit, facts, folds, seed),
          SplitByGroup(kOriginSplit, facts.origin, facts, folds, seed)};
}

std::vector<int> ShuffledLabels(const std::vector<int>& faulty, std::uint64_t seed) {
  std::vector<int> labels = faulty;
  std::mt19937_64 random(seed);
  Shuffle(labels, random);
  return labels;
}

}  // namespace strainwave::analysis::joint_dynamics
