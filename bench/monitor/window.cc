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

std::size_t SamplesOf(const VibrationChunk& chunk) {
  return chunk.samples.empty() ? 0 : chunk.samples.front().size();
}

std::int64_t TimeAt(const VibrationChunk& chunk, std::size_t sample) {
  return chunk.time_ns + std::llround(static_cast<double>(sample) * 1e9 / chunk.sample_rate_hz);
}

}  // namespace

std::vector<VibrationWindow> WindowCutter::Add(const VibrationChunk& chunk) {
  if (!chunk.trouble.empty()) {
    BreakOff("the stream broke off");
    told_ = false;
    Tell(chunk, {SignalFaultKind::kUnreadable, chunk.trouble});
    told_ = false;
    return std::exchange(done_, {});
  }
  if (!chunk.gap.empty()) {
    BreakOff(chunk.gap);
  } else if (chunk.begins_measurement) {
    BeginMeasurement();
  } else if (open_ && !Continues(chunk)) {
    BreakOff("the stream has a gap, or changes its rate or channels");
  }
  const auto trigger = std::ranges::find(chunk.channels, rule_.trigger_channel);
  if (rule_.by == WindowRule::By::kRevolution) {
    AddByTurn(chunk, rule_.turns);
  } else if (rule_.by == WindowRule::By::kTraining) {
    AddAsTrained(chunk);
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
  // A stream without marks never ends at the end of a window; that is no fault.
  const bool by_training = rule_.by == WindowRule::By::kTraining && rule_.length != WindowLength{};
  if (rule_.by == WindowRule::By::kRevolution || by_training) Restart();
  CloseWith({SignalFaultKind::kGap, "the stream ended (expected the whole window)"});
  return std::exchange(done_, {});
}

bool WindowCutter::Continues(const VibrationChunk& chunk) const {
  const double jitter_ns = kMostJitter * 1e9 / open_->sample_rate_hz;
  return chunk.sample_rate_hz == open_->sample_rate_hz && chunk.channels == open_->channels &&
         (chunk.is_counted || std::abs(static_cast<double>(chunk.time_ns - open_->end_ns)) <= jitter_ns);
}

void WindowCutter::BreakOff(const std::string& why) {
  CloseWith({SignalFaultKind::kGap, why + " (expected the whole window)"});
  Restart();
  above_ = true;
}

// A window never goes on into another measurement. One that a mark began ends there, one that an edge began
// is broken off; turns and samples that are left over belong to none.
void WindowCutter::BeginMeasurement() {
  const bool by_trigger = rule_.by == WindowRule::By::kTrigger;
  const bool of_training = rule_.by == WindowRule::By::kTraining && rule_.length == WindowLength{};
  if (by_trigger && !rule_.trigger_channel.empty()) {
    BreakOff("another measurement began");
  } else if (!by_trigger && !of_training) {
    Restart();
  }
}

void WindowCutter::Restart() {
  open_.reset();
  sequence_.reset();
  turned_.reset();
}

std::size_t WindowCutter::SamplesAt(double rate_hz, std::size_t samples) const {
  if (rule_.sample_rate_hz == 0.0) return samples;
  return static_cast<std::size_t>(
      std::llround(static_cast<double>(samples) * std::max(1.0, std::round(rate_hz / rule_.sample_rate_hz))));
}

void WindowCutter::AddAsTrained(const VibrationChunk& chunk) {
  if (rule_.length == WindowLength{}) {
    AddByMark(chunk);
    return;
  }
  if (rule_.length.turns > 0) {
    AddByTurn(chunk, rule_.length.turns / std::abs(rule_.ratio));
  } else {
    AddBySamples(chunk);
  }
  if (!chunk.ends_measurement) return;
  FinishSequence();
  Restart();
}

void WindowCutter::AddBySamples(const VibrationChunk& chunk) {
  const auto whole = static_cast<double>(SamplesAt(chunk.sample_rate_hz, rule_.length.samples));
  std::size_t from = 0;
  for (std::size_t i = 0; i < SamplesOf(chunk); ++i) AddInSequence(chunk, i, counted_++, whole, from);
  AddRest(chunk, from);
  // That its last sample was counted is all that a window waits for.
  FinishSequence();
}

void WindowCutter::AddInSequence(const VibrationChunk& chunk, std::size_t sample, double position,
                                 double length, std::size_t& from) {
  if (!sequence_) sequence_.emplace(length);
  if (const auto ended = sequence_->Add(position)) {
    Append(chunk, from, sample);
    rule_.by == WindowRule::By::kTraining ? Close(ended->count) : Close();
    from = sample;
  }
  if (!open_) Open(chunk, sample);
}

void WindowCutter::AddRest(const VibrationChunk& chunk, std::size_t from) {
  Append(chunk, from, SamplesOf(chunk));
  // A window that was given up is not gone on with in its middle.
  if (!open_) sequence_.reset();
}

void WindowCutter::FinishSequence() {
  if (!open_ || !sequence_) return;
  const auto last = sequence_->Finish();
  if (!last) return;
  Close(last->count);
  sequence_.reset();
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
  const std::size_t whole = SamplesAt(chunk.sample_rate_hz, rule_.trigger_samples);
  for (std::size_t i = 0; i < trigger.size();) {
    if (!open_) {
      const bool above = trigger[i] >= rule_.trigger_level;
      const bool edge = above && !above_;
      above_ = above;
      if (edge) Open(chunk, i);
      if (!edge) ++i;
      continue;
    }
    const std::size_t missing = whole - open_->samples.front().size();
    const std::size_t to = std::min(trigger.size(), i + missing);
    Append(chunk, i, to);
    above_ = trigger[to - 1] >= rule_.trigger_level;
    if (open_ && open_->samples.front().size() >= whole) Close();
    i = to;
  }
}

void WindowCutter::AddByTurn(const VibrationChunk& chunk, double turns_a_window) {
  if (chunk.output_turns.size() != SamplesOf(chunk)) {
    BreakOff("the angle of the output shaft is not known any more");
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
    const auto distance = [this](double of) { return std::abs(of - turned_from_); };
    if (turned_ && distance(turns) < distance(*turned_) - kFlicker) {
      Append(chunk, from, i);
      CloseWith({SignalFaultKind::kGap, "the shaft turned back (expected a turn in one direction)"});
      Restart();
      from = i;
    }
    if (!turned_) turned_from_ = turns;
    turned_ = turns;
    AddInSequence(chunk, i, distance(turns), turns_a_window, from);
  }
  AddRest(chunk, from);
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

void WindowCutter::Close(std::size_t count) {
  if (!open_) return;
  if (!open_->fault && open_turns_.size() == open_->samples.front().size()) {
    if (const auto samples = SamplesPerUnit(open_turns_))
      open_->samples_per_turn = *samples / std::abs(rule_.ratio);
  }
  for (auto& channel : open_->samples) channel.resize(std::min(channel.size(), count));
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
