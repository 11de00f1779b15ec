// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/outbox.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace strainwave::bench {
namespace {

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

}  // namespace

void Outbox::Push(std::vector<protocols::SparkplugMetric> metrics, bool live) {
  if (!live) MakeHistorical(metrics);
  const std::size_t bytes = BytesOf(metrics);
  entries_.push_back({std::move(metrics), bytes, std::nullopt});
  bytes_ += bytes;
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

void Outbox::Acknowledge(int ticket) {
  std::erase(given_up_, ticket);
  const auto entry =
      std::ranges::find_if(entries_, [ticket](const Entry& candidate) { return candidate.ticket == ticket; });
  if (entry != entries_.end()) Remove(entry);
}

void Outbox::ConnectionLost() {
  for (Entry& entry : entries_) {
    entry.ticket.reset();
    MakeHistorical(entry.metrics);
  }
  under_way_ = 0;
  dropped_ += given_up_.size();
  given_up_.clear();
}

void Outbox::Remove(const std::deque<Entry>::iterator& entry) {
  bytes_ -= entry->bytes;
  under_way_ -= entry->ticket.has_value();
  entries_.erase(entry);
}

}  // namespace strainwave::bench
