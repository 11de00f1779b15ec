// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "bench/notices/notice_sender.h"

namespace strainwave::bench {

/// Sends with a thread for each channel, so that one that is dead holds up no other.
class NoticePost {
 public:
  struct Outcome {
    std::string channel;
    std::string id;       // of the notice
    std::string trouble;  // empty: it was taken
  };

  explicit NoticePost(std::vector<NamedSender> senders);
  NoticePost(const NoticePost&) = delete;
  NoticePost& operator=(const NoticePost&) = delete;
  /// Waits for what is under way.
  ~NoticePost();

  std::vector<std::string> channels() const;
  /// Whether the channel could be given a notice: it sends one at a time.
  bool IsFree(std::string_view channel) const;
  bool IsFree() const;  // all of them
  void Send(std::string_view channel, const Notice& notice);
  /// What has come of notices since the last call; waits for the first of it for so long.
  std::vector<Outcome> Take(std::chrono::milliseconds patience);

 private:
  struct Channel;

  void Work(Channel& channel);

  mutable std::mutex mutex_;
  std::condition_variable given_;
  std::condition_variable done_;
  bool stop_{};
  std::vector<Outcome> outcomes_;
  std::vector<std::unique_ptr<Channel>> channels_;
};

}  // namespace strainwave::bench
