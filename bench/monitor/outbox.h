// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "protocols/sparkplug.h"

namespace strainwave::bench {

/// What may wait for a broker, whichever is reached first.
struct OutboxBounds {
  std::size_t windows{10'000};
  std::size_t bytes{std::size_t{64} << 20};
};

/// What is to be published, oldest first. An entry leaves only when the broker has acknowledged it, or when
/// the bounds are exceeded: then the oldest goes, and is counted. Not for several threads.
class Outbox {
 public:
  explicit Outbox(OutboxBounds bounds) : bounds_(bounds) {}

  /// @param live  there is a connection with a birth; without one the values become historical.
  void Push(std::vector<protocols::SparkplugMetric> metrics, bool live);

  /// The oldest entry that is not under way, historical where it waited for a connection; nothing when there
  /// is none. The pointer holds until the next call of another function.
  const std::vector<protocols::SparkplugMetric>* Next();
  /// What `Next` gave was handed to the network under this number.
  void Sent(int ticket);
  /// The broker has it. Numbers that are not known, or no longer, are passed over.
  void Acknowledge(int ticket);
  /// What was under way may have arrived or not: it waits again, and is historical.
  void ConnectionLost();

  std::size_t size() const { return entries_.size(); }
  std::size_t bytes() const { return bytes_; }
  std::size_t under_way() const { return under_way_; }
  /// Entries that went unacknowledged; one that was under way counts once its connection is lost.
  std::uint64_t dropped() const { return dropped_; }

 private:
  struct Entry {
    std::vector<protocols::SparkplugMetric> metrics;
    std::size_t bytes{};
    std::optional<int> ticket;
  };
  void Remove(const std::deque<Entry>::iterator& entry);
  std::deque<Entry>::iterator FirstWaiting();

  OutboxBounds bounds_;
  std::deque<Entry> entries_;
  std::size_t bytes_{};
  std::size_t under_way_{};
  std::uint64_t dropped_{};
  std::vector<int> given_up_;  // tickets of entries that went while they were under way, and may yet arrive
};

}  // namespace strainwave::bench
