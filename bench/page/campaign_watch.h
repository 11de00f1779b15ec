// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bench/page/page_state.h"

namespace strainwave::bench {

/// The newest snapshot of a campaign and the newest lines of its journal.
struct WatchedCampaign {
  CampaignSnapshot snapshot;
  std::vector<Event> events;  // the newest, oldest first
  std::uint64_t version{};    // higher with every change that is worth telling
};

/// Reads the folder of a campaign ten times a second, in a thread of its own, and writes nothing. A folder
/// that is gone, moved or damaged is told in the snapshot and looked at again.
class CampaignWatch {
 public:
  /// Reads it once. @throws as OpenCampaign.
  explicit CampaignWatch(const CampaignFolder& folder);
  CampaignWatch(const CampaignWatch&) = delete;
  CampaignWatch& operator=(const CampaignWatch&) = delete;
  ~CampaignWatch();

  /// From now on; `changed` is called from the watch's thread.
  void Begin(std::function<void()> changed);
  /// Reads it now; for whoever does without the thread, in place of Begin.
  WatchedCampaign Look();
  WatchedCampaign Newest() const;
  /// The snapshot alone, without the lines of the journal.
  CampaignSnapshot Snapshot() const;
  std::uint64_t version() const { return version_; }

 private:
  struct Opened;

  void Watch();
  WatchedCampaign Read();
  bool IsInPlace() const;

  CampaignFolder folder_;
  std::unique_ptr<Opened> opened_;
  std::function<void()> changed_;
  mutable std::mutex mutex_;
  std::condition_variable stopping_;
  bool stop_{};
  WatchedCampaign newest_;
  std::atomic<std::uint64_t> version_{};
  std::thread thread_;
};

}  // namespace strainwave::bench
