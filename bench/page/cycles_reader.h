// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bench/campaign/folder.h"
#include "bench/page/cycles.h"

namespace strainwave::bench {

/// Answers questions for cycles, which take the longer the more there are, in a thread of its own with its
/// own view of the journal. The newest answers are kept: many viewers who ask the same cost one reading.
class CyclesReader {
 public:
  using Done = std::function<void(int status, std::string json)>;

  static constexpr std::size_t kMostWaiting = 64;

  explicit CyclesReader(const CampaignFolder& folder);
  CyclesReader(const CyclesReader&) = delete;
  CyclesReader& operator=(const CyclesReader&) = delete;
  ~CyclesReader();

  /// @param cycles_complete  in the journal, as far as is known: what is older counts as old.
  /// @param done  is called from the reader's thread.
  /// @return false where too many wait already.
  bool Ask(const CyclesQuery& query, int cycles_complete, Done done);

 private:
  struct Question {
    CyclesQuery query;
    int cycles_complete{};
    Done done;
  };
  struct Answer {
    CyclesQuery query;
    int cycles_complete{};
    std::string json;
  };

  void Work();
  std::string Read(const Question& question);

  const CampaignFolder folder_;
  std::deque<Answer> answers_;  // newest first
  std::mutex mutex_;
  std::condition_variable asked_;
  std::deque<Question> questions_;
  bool stop_{};
  std::thread thread_;
};

}  // namespace strainwave::bench
