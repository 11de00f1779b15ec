// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/outbox.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "bench/monitor/sparkplug_metrics.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kMostAtOnce = 100;  // into the store

// The memory behind an entry, to a few bytes a metric.
std::size_t BytesOf(const std::vector<protocols::SparkplugMetric>& metrics) {
  std::size_t bytes = sizeof(std::vector<protocols::SparkplugMetric>);
  for (const auto& metric : metrics) {
    bytes += sizeof(metric) + metric.name.capacity();
    if (const auto* text = std::get_if<std::string>(&metric.value)) bytes += text->capacity();
  }
  return bytes;
}

void MakeHistorical(std::vector<protocols::SparkplugMetric>& metrics) {
  for (auto& metric : metrics) metric.is_historical = true;
}

std::int64_t WindowOf(const std::vector<protocols::SparkplugMetric>& metrics) {
  const auto found = std::ranges::find(metrics, kWindowMetric, &protocols::SparkplugMetric::name);
  if (found == metrics.end()) return 0;
  const auto* number = std::get_if<std::int64_t>(&found->value);
  return number == nullptr ? 0 : *number;
}

}  // namespace

Outbox::Outbox(OutboxBounds bounds, std::unique_ptr<OutboxStore> store)
    : bounds_(bounds), store_(std::move(store)) {
  if (!store_) return;
  dropped_ = written_dropped_ = store_->dropped();
  for (OutboxStore::Entry& kept : store_->Entries()) {
    MakeHistorical(kept.metrics);
    const std::size_t bytes = BytesOf(kept.metrics);
    entries_.push_back({std::move(kept.metrics), bytes, std::nullopt, kept.id});
    bytes_ += bytes;
  }
  KeepWithin();
  Write();
}

void Outbox::Push(std::vector<protocols::SparkplugMetric> metrics, bool live) {
  if (!live) MakeHistorical(metrics);
  const std::size_t bytes = BytesOf(metrics);
  entries_.push_back({std::move(metrics), bytes, std::nullopt});
  bytes_ += bytes;
  KeepWithin();
  Write();
}

void Outbox::KeepWithin() {
  while (!entries_.empty() && (entries_.size() > bounds_.windows || bytes_ > bounds_.bytes)) {
    if (const auto ticket = entries_.front().ticket) {
      given_up_.push_back(*ticket);
    } else {
      ++dropped_;
    }
    Remove(entries_.begin());
  }
}

std::deque<Outbox::Entry>::iterator Outbox::FirstWaiting() {
  return std::ranges::find_if(entries_, [](const Entry& entry) { return !entry.ticket; });
}

const std::vector<protocols::SparkplugMetric>* Outbox::Next() {
  const auto entry = FirstWaiting();
  return entry == entries_.end() ? nullptr : &entry->metrics;
}

void Outbox::Sent(int ticket) {
  const auto entry = FirstWaiting();
  if (entry == entries_.end()) throw std::logic_error("sent, but nothing was waiting");
  entry->ticket = ticket;
  ++under_way_;
}

void Outbox::Acknowledge(std::span<const int> tickets) {
  for (const int ticket : tickets) {
    std::erase(given_up_, ticket);
    const auto entry = std::ranges::find_if(
        entries_, [ticket](const Entry& candidate) { return candidate.ticket == ticket; });
    if (entry != entries_.end()) Remove(entry);
  }
  Write();
}

void Outbox::Write() {
  if (!store_) return;
  // The newest ones, which are not in the store yet: more than one only after it could not be written.
  auto added = entries_.end();
  while (added != entries_.begin() && std::prev(added)->id == 0) --added;
  if (added == entries_.end() && removed_.empty() && dropped_ == written_dropped_) return;
  OutboxStore::Change change{.added = {}, .last_window = 0, .removed = removed_, .dropped = dropped_};
  for (auto entry = added; entry != entries_.end() && change.added.size() < kMostAtOnce; ++entry) {
    change.added.push_back(protocols::EncodeMetrics(entry->metrics));
    change.last_window = WindowOf(entry->metrics);
  }
  try {
    for (const std::int64_t id : store_->Make(change)) (added++)->id = id;
    removed_.clear();
    written_dropped_ = dropped_;
    trouble_.clear();
  } catch (const DatabaseError& error) {
    trouble_ = error.what();
  }
}

void Outbox::KeepNextBirth(int number) {
  if (!store_) return;
  try {
    store_->KeepNextBirth(number);
  } catch (const DatabaseError& error) {
    trouble_ = error.what();
  }
}

void Outbox::ConnectionLost() {
  for (Entry& entry : entries_) {
    entry.ticket.reset();
    MakeHistorical(entry.metrics);
  }
  under_way_ = 0;
  dropped_ += given_up_.size();
  given_up_.clear();
  Write();
}

void Outbox::Remove(const std::deque<Entry>::iterator& entry) {
  bytes_ -= entry->bytes;
  under_way_ -= entry->ticket.has_value();
  if (entry->id != 0) removed_.push_back(entry->id);
  entries_.erase(entry);
}

}  // namespace strainwave::bench
