// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "bench/sha256.h"

namespace strainwave::bench {

/// Where the files of a campaign are (docs/contract.md#campaign-folder).
struct CampaignFolder {
  std::filesystem::path root;

  std::filesystem::path Schedule() const { return root / "schedule.yaml"; }
  std::filesystem::path Bench() const { return root / "bench.yaml"; }
  std::filesystem::path Plant() const { return root / "plant.yaml"; }
  std::filesystem::path Commissioned() const;
  std::filesystem::path Journal() const { return root / "campaign.db"; }
  std::filesystem::path Cycles() const { return root / "cycles"; }
  std::filesystem::path CycleFile(int cycle) const;
  /// Finished phases of the cycle that is under way; gone when its file has appeared.
  std::filesystem::path Unfinished() const { return root / "unfinished"; }
  std::filesystem::path UnfinishedFile(int cycle, int step, int repeat, int attempt) const;
  /// Raw streams of phases that the schedule keeps them of.
  std::filesystem::path Streams() const { return root / "streams"; }
  std::filesystem::path Faults() const { return root / "faults"; }
  std::filesystem::path BusLogs() const { return root / "can"; }
  std::filesystem::path Checkpoint() const { return root / "checkpoint"; }
  /// What the bench shows while the campaign runs; gone when it does not.
  std::filesystem::path Readings() const { return root / "readings"; }
  /// Smallest and largest of the same over time, and what came of each source of samples; both stay.
  std::filesystem::path Envelope() const { return root / "envelope"; }
  std::filesystem::path Sources() const { return root / "sources"; }
  std::filesystem::path Pictures() const { return root / "pictures"; }
  std::filesystem::path Lock() const { return root / "lock"; }
};

/// A copy of what the campaign was started with, and the journal's property that holds its SHA-256: empty
/// where there was no such file, none in campaigns of versions that did not note it.
struct FrozenFile {
  std::filesystem::path file;
  const char* property;
};
std::vector<FrozenFile> FrozenFiles(const CampaignFolder& folder);

/// Holds a campaign for one running process; the kernel lets go when the process ends, however it ends.
/// Where nothing has become of the campaign by then, the lock goes, and the folder if it made that.
class CampaignLock {
 public:
  /// Makes the folder where there is none.
  /// @throws BenchError when another process holds it, with that process's id.
  explicit CampaignLock(const CampaignFolder& folder);
  CampaignLock(const CampaignLock&) = delete;
  CampaignLock& operator=(const CampaignLock&) = delete;
  ~CampaignLock();

  /// Process id of the holder; 0 when nobody runs the campaign.
  static int Holder(const CampaignFolder& folder);

 private:
  void Open();

  const CampaignFolder folder_;
  bool made_folder_{};
  int descriptor_{-1};
};

/// The whole file. @throws std::system_error.
std::string ReadText(const std::filesystem::path& file);

}  // namespace strainwave::bench
