// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/acquisition_source.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/units.h"
#include "daq/value_bounds.h"

namespace strainwave::bench {
namespace {

using daq::acquisition::BlockFlag;
using daq::acquisition::BlockHeader;
using daq::acquisition::ChannelDescription;
using daq::acquisition::NextResult;
using daq::acquisition::SampleBlock;
using daq::acquisition::SourceDescription;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;

constexpr std::string_view kAcceleration = "_m_per_s2";

SourceDescription Started(daq::acquisition::SampleSource& source) {
  source.Start();
  return source.description();
}

std::vector<std::string> NamesOf(const SourceDescription& description, const AcquisitionStream& stream) {
  std::vector<std::string> names;
  for (const ChannelDescription& channel : description.channels) {
    const bool lacks_unit = channel.unit == "m/s^2" && !channel.name.ends_with(kAcceleration);
    names.push_back(lacks_unit ? channel.name + std::string(kAcceleration) : channel.name);
  }
  for (const auto& [from, to] : stream.renamed) {
    const auto found = std::ranges::find(description.channels, from, &ChannelDescription::name);
    if (found == description.channels.end()) {
      std::vector<std::string> known;
      for (const ChannelDescription& channel : description.channels) known.push_back(channel.name);
      throw std::invalid_argument(fmt::format("{} has no channel {} (expected one of {})", description.name,
                                              from, fmt::join(known, ", ")));
    }
    names[static_cast<std::size_t>(found - description.channels.begin())] = to;
  }
  return names;
}

std::int64_t UtcNanoseconds() {
  return nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

// UTC less the steady clock. A thread that is held up between its two readings would be wrong by that time:
// UTC is read between two steady times, and the narrowest of a few such readings holds.
nanoseconds UtcOfSteady() {
  constexpr int kReadings = 3;
  nanoseconds narrowest = nanoseconds::max();
  nanoseconds utc_of_steady{};
  for (int reading = 0; reading < kReadings; ++reading) {
    const nanoseconds before = steady_clock::now().time_since_epoch();
    const nanoseconds utc = std::chrono::system_clock::now().time_since_epoch();
    const nanoseconds after = steady_clock::now().time_since_epoch();
    if (after - before >= narrowest) continue;
    narrowest = after - before;
    utc_of_steady = utc - before - narrowest / 2;
  }
  return utc_of_steady;
}

std::int64_t Nanoseconds(double samples, double rate_hz) { return std::llround(samples * 1e9 / rate_hz); }

// What is missing before a block, in words; empty where nothing is.
std::string GapOf(const BlockHeader& header) {
  if (header.lost_before > 0) {
    const bool about = (header.flags & BlockFlag::kLostIsEstimate) != 0;
    return fmt::format("{}{} samples were lost", about ? "about " : "", header.lost_before);
  }
  if ((header.flags & BlockFlag::kAfterReset) != 0) return "the device's counter of samples began anew";
  if ((header.flags & BlockFlag::kDeviceOverrun) != 0) return "the device lost samples";
  return {};
}

}  // namespace

AcquisitionSource::AcquisitionSource(std::unique_ptr<daq::acquisition::SampleSource> source,
                                     AcquisitionStream stream)
    : source_(std::move(source)),
      stream_(std::move(stream)),
      description_(Started(*source_)),
      channels_(NamesOf(description_, stream_)),
      block_(description_.channels.size() * description_.most_samples_a_block),
      ledger_({.bits = description_.counter_bits}, description_.rate_hz),
      clock_(daq::acquisition::ClockModelSettings{}),
      began_(steady_clock::now()),
      last_block_(began_),
      last_ns_(stream_.start_ns) {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i] != "input_speed_rpm" && channels_[i] != "input_speed_rad_per_s") continue;
    speed_channel_ = i;
    if (channels_[i] == "input_speed_rpm") speed_unit_rad_per_s_ = RadPerSFromRpm(1.0);
  }
}

AcquisitionSource::~AcquisitionSource() { source_->Stop(); }

std::int64_t AcquisitionSource::NowNanoseconds() const {
  if (!stream_.pace) return UtcNanoseconds();
  if (!std::isfinite(*stream_.pace)) return last_ns_;
  const std::chrono::duration<double, std::nano> passed = steady_clock::now() - began_;
  return stream_.start_ns + std::llround(passed.count() * *stream_.pace);
}

AcquisitionSource::Got AcquisitionSource::Next(std::chrono::milliseconds patience, VibrationChunk& chunk) {
  switch (source_->Next(block_, patience)) {
    case NextResult::kBlock:
      return Take(chunk);
    case NextResult::kNothingYet:
      return Silence(chunk);
    case NextResult::kEnded:
      return Got::kEnd;
    case NextResult::kFailed:
      return Tell(fmt::format("{} (expected samples; the device is tried again)", source_->trouble()), chunk);
  }
  return Got::kEnd;
}

AcquisitionSource::Got AcquisitionSource::Silence(VibrationChunk& chunk) {
  const nanoseconds silent = steady_clock::now() - last_block_;
  if (stream_.pace || silent < stream_.silent_after) return Got::kNothingYet;
  const double silent_s = std::chrono::duration<double>(stream_.silent_after).count();
  return Tell(fmt::format("{} has sent no samples for {:g} s (expected {:g} a second)", description_.name,
                          silent_s, description_.rate_hz),
              chunk);
}

AcquisitionSource::Got AcquisitionSource::Tell(const std::string& trouble, VibrationChunk& chunk) {
  if (std::exchange(told_, true)) return Got::kNothingYet;
  chunk = {};
  chunk.time_ns = NowNanoseconds();
  chunk.sample_rate_hz = description_.rate_hz;
  chunk.channels = channels_;
  chunk.origin = description_.name;
  chunk.trouble = trouble;
  return Got::kChunk;
}

// Of a block's first sample.
std::int64_t AcquisitionSource::TimeOf(const BlockHeader& header) {
  const auto counted = [&](std::uint64_t samples) {
    return Nanoseconds(static_cast<double>(samples), description_.rate_hz);
  };
  if (stream_.pace) return stream_.start_ns + counted(header.first_sample);
  // The sample counter is the device's clock: even, and off the nominal rate by as little as its quartz.
  clock_.Add(nanoseconds(counted(header.first_sample + header.samples)), header.arrival);
  const nanoseconds first = clock_.estimate()
                                ? clock_.estimate()->ToHost(nanoseconds(counted(header.first_sample)))
                                : header.arrival - nanoseconds(counted(header.samples));
  return (UtcOfSteady() + first).count();
}

AcquisitionSource::Got AcquisitionSource::Take(VibrationChunk& chunk) {
  ledger_.Admit(block_);
  const BlockHeader& header = block_.header;
  if (header.samples == 0) return Got::kNothingYet;
  last_block_ = steady_clock::now();
  told_ = false;
  chunk = {};
  chunk.time_ns = TimeOf(header);
  chunk.sample_rate_hz = description_.rate_hz;
  chunk.channels = channels_;
  chunk.origin = description_.name;
  chunk.is_counted = true;
  chunk.gap = GapOf(header);
  chunk.samples.resize(channels_.size());
  for (std::size_t channel = 0; channel < channels_.size(); ++channel) {
    const auto& calibration = description_.channels[channel].calibration;
    chunk.samples[channel].reserve(header.samples);
    for (std::size_t sample = 0; sample < header.samples; ++sample) {
      chunk.samples[channel].push_back(calibration.Apply(block_.Value(sample, channel)));
    }
  }
  AddTurns(chunk);
  last_ns_ = chunk.time_ns + Nanoseconds(header.samples, description_.rate_hz);
  return Got::kChunk;
}

void AcquisitionSource::AddTurns(VibrationChunk& chunk) {
  if (!speed_channel_ && !stream_.input_speed_rad_per_s) return;
  // Where the speed is none, the turns of this block are not known, and those of the next go on from here.
  if (speed_channel_ &&
      daq::FindImplausible(chunk.samples[*speed_channel_], daq::BoundsOf(channels_[*speed_channel_])))
    return;
  const double turns_per_rad = 1.0 / (kTwoPi * stream_.ratio * description_.rate_hz);
  for (std::size_t i = 0; i < block_.header.samples; ++i) {
    chunk.output_turns.push_back(output_turns_);
    const double speed_rad_per_s = speed_channel_ ? speed_unit_rad_per_s_ * chunk.samples[*speed_channel_][i]
                                                  : *stream_.input_speed_rad_per_s;
    output_turns_ += speed_rad_per_s * turns_per_rad;
  }
}

}  // namespace strainwave::bench
