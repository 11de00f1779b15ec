// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/window.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace strainwave::bench {
namespace {

// In samples. Time stamps of a stream are those of its blocks: a few samples of jitter are no gap.
constexpr double kMostJitter = 4.0;
// In turns. An encoder at rest flickers; more than that is a shaft that turns back.
constexpr double kFlicker = 1e-3;
// As of records (record_features.h): over each part of a window the speed is that of the whole.
constexpr double kSteady = 0.01;
constexpr std::size_t kParts = 8;

std::size_t SamplesOf(const VibrationChunk& chunk) {
  return chunk.samples.empty() ? 0 : chunk.samples.front().size();
}

std::int64_t TimeAt(const VibrationChunk& chunk, std::size_t sample) {
  return chunk.time_ns + std::llround(static_cast<double>(sample) * 1e9 / chunk.sample_rate_hz);
}

// Samples for one turn of the output shaft, if it turns evenly.
std::optional<double> SamplesPerTurn(const std::vector<double>& turns) {
  if (turns.size() <= kParts) return std::nullopt;
  const std::size_t part = (turns.size() - 1) / kParts;
  const double turned = turns[kParts * part] - turns.front();
  for (std::size_t k = 0; k < kParts; ++k) {
    const double share = turns[(k + 1) * part] - turns[k * part];
    if (!(std::abs(share * kParts / turned - 1.0) <= kSteady)) return std::nullopt;
  }
  return static_cast<double>(kParts * part) / std::abs(turned);
}

}  // namespace

std::vector<VibrationWindow> WindowCutter::Add(const VibrationChunk& chunk) {
  if (!chunk.trouble.empty()) {
    CloseWith({SignalFaultKind::kGap, "the stream broke off (expected the whole window)"});
    told_ = false;
    Tell(chunk, {SignalFaultKind::kUnreadable, chunk.trouble});
    told_ = false;
    turned_.reset();
    return std::exchange(done_, {});
  }
  if (open_ && !chunk.begins_measurement && !Continues(chunk)) {
    CloseWith({SignalFaultKind::kGap,
               "the stream has a gap, or changes its rate or channels (expected the whole window)"});
    turned_.reset();
    above_ = true;
  }
  const auto trigger = std::ranges::find(chunk.channels, rule_.trigger_channel);
  if (rule_.by == WindowRule::By::kRevolution) {
    AddByTurn(chunk);
  } else if (rule_.trigger_channel.empty()) {
    AddByMark(chunk);
  } else if (trigger != chunk.channels.end()) {
    told_ = false;
    AddByEdge(chunk, chunk.samples[static_cast<std::size_t>(trigger - chunk.channels.begin())]);
  } else {
    Tell(chunk, {SignalFaultKind::kMissingChannel,
                 fmt::format("there is no channel {} (expected the trigger)", rule_.trigger_channel)});
  }
  return std::exchange(done_, {});
}

std::vector<VibrationWindow> WindowCutter::Finish() {
  // By revolution the last turn is never whole; that is no fault.
  if (rule_.by == WindowRule::By::kRevolution) open_.reset();
  CloseWith({SignalFaultKind::kGap, "the stream ended (expected the whole window)"});
  return std::exchange(done_, {});
}

bool WindowCutter::Continues(const VibrationChunk& chunk) const {
  const double jitter_ns = kMostJitter * 1e9 / open_->sample_rate_hz;
  return chunk.sample_rate_hz == open_->sample_rate_hz && chunk.channels == open_->channels &&
         std::abs(static_cast<double>(chunk.time_ns - open_->end_ns)) <= jitter_ns;
}

void WindowCutter::AddByMark(const VibrationChunk& chunk) {
  if (chunk.begins_measurement) {
    Close();
    Open(chunk, 0);
  }
  Append(chunk, 0, SamplesOf(chunk));
  if (chunk.ends_measurement) Close();
}

void WindowCutter::AddByEdge(const VibrationChunk& chunk, const std::vector<double>& trigger) {
  for (std::size_t i = 0; i < trigger.size();) {
    if (!open_) {
      const bool above = trigger[i] >= rule_.trigger_level;
      const bool edge = above && !above_;
      above_ = above;
      if (edge) Open(chunk, i);
      if (!edge) ++i;
      continue;
    }
    const std::size_t missing = rule_.trigger_samples - open_->samples.front().size();
    const std::size_t to = std::min(trigger.size(), i + missing);
    Append(chunk, i, to);
    above_ = trigger[to - 1] >= rule_.trigger_level;
    if (open_ && open_->samples.front().size() >= rule_.trigger_samples) Close();
    i = to;
  }
}

void WindowCutter::AddByTurn(const VibrationChunk& chunk) {
  if (chunk.output_turns.size() != SamplesOf(chunk)) {
    Tell(chunk,
         {SignalFaultKind::kMissingChannel,
          "the angle of the output shaft is not known (expected a speed of the input and the ratio, or "
          "windows by trigger)"});
    return;
  }
  told_ = false;
  std::size_t from = 0;
  for (std::size_t i = 0; i < chunk.output_turns.size(); ++i) {
    const double turns = chunk.output_turns[i];
    if (!turned_) window_from_turns_ = turns;
    const bool back =
        turned_ && std::abs(turns - window_from_turns_) < std::abs(*turned_ - window_from_turns_) - kFlicker;
    turned_ = turns;
    if (back) {
      Append(chunk, from, i);
      CloseWith({SignalFaultKind::kGap, "the shaft turned back (expected a turn in one direction)"});
      window_from_turns_ = turns;
      from = i;
    } else if (std::abs(turns - window_from_turns_) >= rule_.turns) {
      Append(chunk, from, i);
      Close();
      window_from_turns_ += std::copysign(rule_.turns, turns - window_from_turns_);
      from = i;
    }
    if (!open_) Open(chunk, i);
  }
  Append(chunk, from, chunk.output_turns.size());
}

void WindowCutter::Open(const VibrationChunk& chunk, std::size_t at) {
  open_.emplace();
  open_->begin_ns = open_->end_ns = TimeAt(chunk, at);
  open_->sample_rate_hz = chunk.sample_rate_hz;
  open_->channels = chunk.channels;
  open_->samples.resize(chunk.channels.size());
  open_->origin = chunk.origin;
  open_turns_.clear();
}

void WindowCutter::Append(const VibrationChunk& chunk, std::size_t from, std::size_t to) {
  if (!open_ || from == to) return;
  for (std::size_t k = 0; k < chunk.samples.size(); ++k) {
    const auto& samples = chunk.samples[k];
    open_->samples[k].insert(open_->samples[k].end(), samples.begin() + static_cast<std::ptrdiff_t>(from),
                             samples.begin() + static_cast<std::ptrdiff_t>(to));
  }
  if (chunk.output_turns.size() >= to) {
    open_turns_.insert(open_turns_.end(), chunk.output_turns.begin() + static_cast<std::ptrdiff_t>(from),
                       chunk.output_turns.begin() + static_cast<std::ptrdiff_t>(to));
  }
  open_->end_ns = TimeAt(chunk, to);
  if (open_->samples.front().size() > rule_.most_samples) {
    CloseWith({SignalFaultKind::kGap, fmt::format("the window does not end within {} samples (expected the "
                                                  "next trigger, or a shaft that turns)",
                                                  rule_.most_samples)});
  }
}

void WindowCutter::Close() {
  if (!open_) return;
  if (!open_->fault && open_turns_.size() == open_->samples.front().size()) {
    if (const auto samples = SamplesPerTurn(open_turns_)) open_->samples_per_turn = *samples / rule_.ratio;
  }
  done_.push_back(*std::exchange(open_, std::nullopt));
}

void WindowCutter::CloseWith(SignalFault fault) {
  if (!open_) return;
  open_->fault = std::move(fault);
  open_->samples.clear();
  Close();
}

void WindowCutter::Tell(const VibrationChunk& chunk, SignalFault fault) {
  if (std::exchange(told_, true)) return;
  done_.push_back({.begin_ns = chunk.time_ns,
                   .end_ns = chunk.time_ns,
                   .sample_rate_hz = chunk.sample_rate_hz,
                   .channels = chunk.channels,
                   .samples = {},
                   .samples_per_turn = {},
                   .origin = chunk.origin,
                   .fault = std::move(fault)});
}

}  // namespace strainwave::bench
