// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/trigger.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "daq/record.h"

namespace strainwave::daq::acquisition {
namespace {

bool BeginsArmed(TriggerKind kind) { return kind == TriggerKind::kAbove || kind == TriggerKind::kBelow; }
bool LooksUpwards(TriggerKind kind) { return kind == TriggerKind::kAbove || kind == TriggerKind::kRising; }

const char* VerbOf(TriggerKind kind) {
  switch (kind) {
    case TriggerKind::kAbove:
      return "is above";
    case TriggerKind::kBelow:
      return "is below";
    case TriggerKind::kRising:
      return "rises to";
    case TriggerKind::kFalling:
      return "falls to";
    case TriggerKind::kEvent:
      return "";
  }
  return "";
}

}  // namespace

TriggeredCapture::TriggeredCapture(const SourceDescription& source, const TriggerSettings& settings)
    : source_(source),
      settings_(settings),
      most_rows_(settings.before + 1 + settings.after),
      is_armed_(BeginsArmed(settings.kind)) {
  if (settings.channel >= source.channels.size()) {
    throw std::invalid_argument(
        fmt::format("channel = {}, but the source has {}", settings.channel, source.channels.size()));
  }
  if (!std::isfinite(settings.level) || !(settings.hysteresis >= 0)) {
    throw std::invalid_argument(
        fmt::format("level = {} and hysteresis = {} are not finite and not below zero", settings.level,
                    settings.hysteresis));
  }
  words_.resize(most_rows_ * source.channels.size());
  stamps_.resize(most_rows_);
}

std::optional<std::string> TriggeredCapture::CauseOf(double value) noexcept {
  if (settings_.kind == TriggerKind::kEvent || !std::isfinite(value)) return std::nullopt;
  const double sign = LooksUpwards(settings_.kind) ? 1 : -1;
  const double beyond = sign * (value - settings_.level);
  if (beyond < 0 && beyond <= -settings_.hysteresis) is_armed_ = true;
  if (beyond < 0 || !is_armed_) return std::nullopt;
  is_armed_ = false;
  return std::string();
}

void TriggeredCapture::Keep(const SampleBlock& block, std::uint32_t sample) noexcept {
  const BlockHeader& header = block.header;
  const std::size_t channels = source_.channels.size();
  const std::uint64_t slot = kept_++ % most_rows_;
  std::copy_n(block.words().data() + std::size_t{sample} * channels, channels,
              words_.begin() + static_cast<std::ptrdiff_t>(slot * channels));
  const bool begins = sample == 0;
  const std::chrono::nanoseconds since_first(std::llround(1e9 * sample / source_.rate_hz));
  stamps_[slot] = {.number = header.first_sample + sample,
                   .device_counter = header.device_counter + sample,
                   .lost = begins ? header.lost_before : 0,
                   .device_time = header.device_time + since_first,
                   .arrival = header.arrival,
                   .flags = begins ? header.flags : 0,
                   .begins = begins};
}

void TriggeredCapture::Take(const SampleBlock& block, const std::function<void(Capture)>& deliver) {
  const BlockHeader& header = block.header;
  const std::size_t channels = source_.channels.size();
  if (header.channels != channels) {
    throw std::invalid_argument(
        fmt::format("a block of {} channels, {} expected", header.channels, channels));
  }
  // Across a gap there is no edge: the signal must be seen on the near side of the level again.
  if ((header.flags & kAfterGap) != 0 && header.samples > 0) is_armed_ = BeginsArmed(settings_.kind);
  for (std::uint32_t i = 0; i < header.samples; ++i) {
    const std::uint64_t number = header.first_sample + i;
    Keep(block, i);
    std::optional<std::string> cause = CauseOf(block.Value(i, settings_.channel));
    if (fired_) cause = std::move(*std::exchange(fired_, std::nullopt));
    if (cause) {
      if (captures_ || (held_off_until_ && number < *held_off_until_)) {
        ++ignored_;
      } else {
        captures_ = true;
        cause_ = std::move(*cause);
        trigger_sample_ = number;
        trigger_frame_ = kept_ - 1;
        held_off_until_ = number + settings_.hold_off;
      }
    }
    if (captures_ && kept_ - 1 - trigger_frame_ >= settings_.after) {
      captures_ = false;
      deliver(Unrolled());
    }
  }
}

void TriggeredCapture::Finish(const std::function<void(Capture)>& deliver) {
  if (!captures_ && fired_ && kept_ > 0) {
    captures_ = true;
    cause_ = std::move(*std::exchange(fired_, std::nullopt));
    trigger_sample_ = stamps_[(kept_ - 1) % most_rows_].number + 1;
    trigger_frame_ = kept_;
  }
  if (!captures_) return;
  captures_ = false;
  deliver(Unrolled());
}

Capture TriggeredCapture::Unrolled() const {
  const std::uint64_t begin = trigger_frame_ - std::min(trigger_frame_, settings_.before);
  const std::size_t channels = source_.channels.size();
  Capture capture{.cause = cause_,
                  .trigger_sample = trigger_sample_,
                  .first_sample = stamps_[begin % most_rows_].number,
                  .trigger_row = trigger_frame_ - begin,
                  .channels = static_cast<std::uint32_t>(channels),
                  .type = source_.type,
                  .rate_hz = source_.rate_hz};
  if (cause_.empty()) {
    capture.cause = fmt::format("{} {} {}", source_.channels[settings_.channel].name, VerbOf(settings_.kind),
                                ShortestText(settings_.level));
  }
  capture.words.reserve((kept_ - begin) * channels);
  for (std::uint64_t frame = begin; frame < kept_; ++frame) {
    const auto at = words_.begin() + static_cast<std::ptrdiff_t>((frame % most_rows_) * channels);
    capture.words.insert(capture.words.end(), at, at + static_cast<std::ptrdiff_t>(channels));
    const Stamp& stamp = stamps_[frame % most_rows_];
    if (stamp.lost > 0 && frame > begin) capture.holes.push_back({frame - begin, stamp.lost});
    if (stamp.begins || frame == begin) {
      capture.pieces.push_back({frame - begin,
                                {.source = source_.source,
                                 .channels = capture.channels,
                                 .type = source_.type,
                                 .flags = stamp.flags,
                                 .device_counter = stamp.device_counter,
                                 .first_sample = stamp.number,
                                 .lost_before = stamp.lost,
                                 .device_time = stamp.device_time,
                                 .arrival = stamp.arrival,
                                 .rate_hz = source_.rate_hz}});
    }
    ++capture.pieces.back().header.samples;
  }
  return capture;
}

}  // namespace strainwave::daq::acquisition
