// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "bench/monitor/board.h"
#include "bench/monitor/outbox.h"
#include "bench/monitor/settings.h"
#include "protocols/sparkplug.h"

namespace strainwave::bench {

/// Publishes to an MQTT broker as a Sparkplug edge node, from a thread of its own: whoever publishes never
/// waits for the network. It connects again for as long as it lives; every connection has a will and a birth
/// of its own, and what was not acknowledged before goes out after that birth as historical, under new
/// sequence numbers.
///
/// Data goes with quality of service 1, where Sparkplug asks for 0: only what a broker acknowledges may be
/// forgotten. Subscribers see no difference. With a primary host named, nothing is sent before that host says
/// that it listens, by Sparkplug 3.0 or 2.2; what it waits for is told. With a store, what waits and the
/// numbers of connections outlive the monitor.
class MqttPublisher {
 public:
  using Log = std::function<void(const std::string& line)>;  // called from any thread

  /// @param board  outlives the publisher; gets the state of the link, gives the values of births.
  /// @param store  may be none. @throws BenchError for certificates that cannot be used, or a store that
  ///   cannot be read or whose entries are of another predictor.
  MqttPublisher(const MqttSettings& settings, Board& board, Log log,
                std::unique_ptr<OutboxStore> store = nullptr);
  MqttPublisher(const MqttPublisher&) = delete;
  MqttPublisher& operator=(const MqttPublisher&) = delete;
  /// Ends the connection with a death; what still waits is lost, unless there is a store.
  ~MqttPublisher();

  /// Puts values into the outbox.
  void Publish(std::vector<protocols::SparkplugMetric> metrics);

  struct NotDelivered {
    std::size_t waiting{};
    std::uint64_t dropped{};  // since the start, for which there was no room
    std::string cause;        // what they waited for at last
  };
  /// Goes on until nothing waits or the time is over, then ends the connection with a death.
  NotDelivered Finish(std::chrono::milliseconds patience);

 private:
  class Connection;

  void Run();
  bool Finished();
  bool FinishedLocked() const;
  void ShowLink();  // with the mutex held
  void RequireSameMetrics() const;
  protocols::MqttMessage Death();
  void TellWaiting(const std::string& words);

  MqttSettings settings_;
  Board& board_;
  Log log_;
  protocols::SparkplugEdgeNode node_;  // of the thread alone
  bool told_broken_{};                 // of the thread alone
  std::string told_cause_;             // of the thread alone
  std::string told_waiting_;           // of the thread alone
  std::string waits_for_;              // of the thread, until it has ended
  std::string told_trouble_;           // of the store

  std::mutex mutex_;
  std::condition_variable wake_;
  Outbox outbox_;
  std::uint64_t dropped_before_;  // by a monitor before this one
  bool live_{};                   // connected and born
  bool stopping_{};
  std::chrono::steady_clock::time_point deadline_{};

  std::thread thread_;
};

}  // namespace strainwave::bench
