// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/monitor/outbox_store.h"
#include "protocols/sparkplug.h"

namespace strainwave::bench {

/// What may wait for a broker, whichever is reached first.
struct OutboxBounds {
  std::size_t windows{10'000};
  std::size_t bytes{std::size_t{64} << 20};
};

/// What is to be published, oldest first. An entry leaves only when the broker has acknowledged it, or when
/// the bounds are exceeded: then the oldest goes, and is counted. Not for several threads.
///
/// With a store every change is on the disk before the call returns, and what a monitor before this one left
/// there comes first, historical. A disk that refuses stops nothing: `trouble` says so, and what could not be
/// written is in memory alone until the next change can be.
class Outbox {
 public:
  /// @param store  may be none. @throws as OutboxStore::Entries.
  explicit Outbox(OutboxBounds bounds, std::unique_ptr<OutboxStore> store = nullptr);

  /// @param live  there is a connection with a birth; without one the values become historical.
  void Push(std::vector<protocols::SparkplugMetric> metrics, bool live);

  /// The oldest entry that is not under way, historical where it waited for a connection; nothing when there
  /// is none. The pointer holds until the next call of another function.
  const std::vector<protocols::SparkplugMetric>* Next();
  /// What `Next` gave was handed to the network under this number.
  void Sent(int ticket);
  /// The broker has them. Numbers that are not known, or no longer, are passed over.
  void Acknowledge(std::span<const int> tickets);
  void Acknowledge(int ticket) { Acknowledge(std::span(&ticket, 1)); }
  /// What was under way may have arrived or not: it waits again, and is historical.
  void ConnectionLost();

  /// Each of what waits, oldest first; null at the end.
  const std::vector<protocols::SparkplugMetric>* At(std::size_t place) const {
    return place < entries_.size() ? &entries_[place].metrics : nullptr;
  }

  /// Of the connection after the next one; it is kept where there is a store.
  void KeepNextBirth(int number);

  /// Why the store cannot be written at the moment; empty where it can.
  const std::string& trouble() const { return trouble_; }

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
    std::int64_t id{};  // in the store; 0: not there
  };
  void Remove(const std::deque<Entry>::iterator& entry);
  void KeepWithin();
  /// Writes what has changed since the last time that the store could be written.
  void Write();
  std::deque<Entry>::iterator FirstWaiting();

  OutboxBounds bounds_;
  std::unique_ptr<OutboxStore> store_;
  std::vector<std::int64_t> removed_;  // and still in the store
  std::uint64_t written_dropped_{};
  std::string trouble_;
  std::deque<Entry> entries_;
  std::size_t bytes_{};
  std::size_t under_way_{};
  std::uint64_t dropped_{};
  std::vector<int> given_up_;  // tickets of entries that went while they were under way, and may yet arrive
};

}  // namespace strainwave::bench
