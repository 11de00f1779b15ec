// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "bench/campaign/folder.h"
#include "bench/page/cycles.h"
#include "bench/serving/worker.h"

namespace strainwave::bench {

/// Answers questions that take long, as cycles do the more there are, in a thread of its own with its own
/// view of the campaign. The newest answers about cycles are kept: many viewers who ask the same cost one
/// reading. Each question is refused (false) where too many wait already.
class JournalReader {
 public:
  /// Called from the reader's thread, with a status of HTTP.
  using Done = std::function<void(int status, std::string json)>;

  static constexpr std::size_t kMostWaiting = 64;

  explicit JournalReader(const CampaignFolder& folder) : folder_(folder) {}

  /// @param cycles_complete  in the journal, as far as is known: what is older counts as old.
  bool AskCycles(const CyclesQuery& query, int cycles_complete, Done done);
  /// `AlarmListJson`. @param all  those that are cleared, too.
  bool AskAlarms(bool all, Done done);
  /// `ReadMeasurements`.
  bool AskMeasurements(int cycle, Done done);
  /// `LiveChannelsJson`.
  bool AskLive(Done done);
  /// Bytes of a picture, with status 200.
  bool AskPicture(const std::filesystem::path& file, Done done);

 private:
  struct Answer {
    CyclesQuery query;
    int cycles_complete{};
    std::string json;
  };

  bool Ask(std::function<std::string()> read, Done done);
  std::string ReadCycles(const CyclesQuery& query, int cycles_complete);

  const CampaignFolder folder_;
  std::deque<Answer> answers_;                         // newest first
  Worker worker_{kMostWaiting, Worker::AtEnd::kDrop};  // its thread reads the above, and ends before
};

}  // namespace strainwave::bench
