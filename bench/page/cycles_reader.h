// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <string>

#include "bench/campaign/folder.h"
#include "bench/page/cycles.h"
#include "bench/serving/worker.h"

namespace strainwave::bench {

/// Answers questions for cycles, which take the longer the more there are, in a thread of its own with its
/// own view of the journal. The newest answers are kept: many viewers who ask the same cost one reading.
class CyclesReader {
 public:
  using Done = std::function<void(int status, std::string json)>;

  static constexpr std::size_t kMostWaiting = 64;

  explicit CyclesReader(const CampaignFolder& folder) : folder_(folder) {}

  /// @param cycles_complete  in the journal, as far as is known: what is older counts as old.
  /// @param done  is called from the reader's thread.
  /// @return false where too many wait already.
  bool Ask(const CyclesQuery& query, int cycles_complete, Done done);

 private:
  struct Answer {
    CyclesQuery query;
    int cycles_complete{};
    std::string json;
  };

  std::string Read(const CyclesQuery& query, int cycles_complete);

  const CampaignFolder folder_;
  std::deque<Answer> answers_;                         // newest first
  Worker worker_{kMostWaiting, Worker::AtEnd::kDrop};  // its thread reads the above, and ends before
};

}  // namespace strainwave::bench
