// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <utility>
#include <vector>

#include "bench/campaign/folder.h"
#include "daq/file_descriptor.h"

namespace strainwave::bench {

/// A campaign's folder, held open with its `cycles/` and `unfinished/`, so that another one that comes in its
/// place, or in theirs, is told from it.
class HeldFolder {
 public:
  /// @throws std::system_error when one of the three cannot be opened.
  explicit HeldFolder(const CampaignFolder& folder);

  const CampaignFolder& folder() const { return folder_; }
  /// The same folder by another path, which leads to it wherever it is moved while this object lives: for
  /// whoever opens files by himself, whenever he likes.
  CampaignFolder wherever() const;

  /// Before anything is written by a path.
  /// @throws BenchError when a path no longer leads to what is held.
  void DemandInPlace() const;
  /// For whoever asks again and again, as each beat of a bench does that runs a thousand times faster than
  /// real time: the same, and nothing where it was looked at within the last 50 ms by the world's clock.
  void WatchInPlace();

 private:
  CampaignFolder folder_;
  std::vector<std::pair<std::filesystem::path, daq::FileDescriptor>> held_;  // the root first
  std::chrono::steady_clock::time_point watched_at_{};
};

}  // namespace strainwave::bench
