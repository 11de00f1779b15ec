// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace strainwave::analysis::joint_dynamics {

/// What is known of each record; groups are consecutive numbers from 0.
struct FileFacts {
  std::vector<int> faulty;  // 0 or 1
  std::vector<int> unit;
  std::vector<int> origin;

  std::size_t files() const { return faulty.size(); }
};

inline constexpr std::string_view kRandomSplit = "random";
inline constexpr std::string_view kFileSplit = "file_left_out";
inline constexpr std::string_view kUnitSplit = "unit_left_out";
inline constexpr std::string_view kOriginSplit = "origin_left_out";

/// Who is tested together, each once, by what was trained on all others.
struct FileSplit {
  std::string name;
  bool by_samples{};  // samples are dealt at random, of one record to both sides: it flatters
  int folds{};
  std::vector<int> fold;   // of each file; empty where samples are dealt
  std::string impossible;  // why there is no such split; empty where there is one
};

/// The four splits: samples at random, whole files, whole units, whole origins left out. Groups are dealt to
/// at most `folds` folds, those of either class in turn, so that a fold has both where that can be. A split
/// of which a fold leaves one class alone to train on says so.
/// @throws std::invalid_argument if lengths differ, there is no file, or fewer than 2 folds.
std::vector<FileSplit> SplitsOfFiles(const FileFacts& facts, int folds, std::uint64_t seed);

/// Labels dealt anew among files, as many of either class as before: the control that must fail.
std::vector<int> ShuffledLabels(const std::vector<int>& faulty, std::uint64_t seed);

}  // namespace strainwave::analysis::joint_dynamics
