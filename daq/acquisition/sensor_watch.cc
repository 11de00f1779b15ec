// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/sensor_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "daq/record.h"

namespace strainwave::daq::acquisition {
namespace {

constexpr double kFoundWithin_s = 2.0;
constexpr double kStuckAtLeast_s = 0.25;  // neighbours are alike beyond chance where an amplifier filters
constexpr double kFlatWindow_s = 0.5;
constexpr double kSilentAfter_s = 1.0;
constexpr double kGoodAfter_s = 1.0;
constexpr std::uint64_t kInARow = 3;
constexpr double kLeastTimeStep_s = 1e-3;
constexpr double kTimeStepInSamples = 2;
// One false alarm in so many chances: a thousand channels at 100 kHz for the life of a bench.
constexpr double kFalseAlarms = 1e-18;
constexpr double kFlatSigmas = 9;
constexpr double kFlattest = 0.3;  // of the noise: margin for a sensor that is quieter today
constexpr double kLeastNoiseForFlatInQuanta = 0.5;
constexpr double kLeastNoiseForStuckInQuanta = 1.0 / 3.0;

// Samples of one value in a row that noise makes too rarely to matter. The worst case is a mean in the middle
// of a step, where one value comes with the probability erf(quantum / (2 sqrt 2 noise)).
std::uint64_t StuckAfter(const RawLimits& limits, double rate_hz) {
  if (!(limits.noise > 0) || limits.noise < kLeastNoiseForStuckInQuanta * limits.quantum) return 0;
  // A float that is not quantised never repeats.
  const double same = std::max(std::erf(limits.quantum / (2 * std::sqrt(2.0) * limits.noise)), 1e-6);
  const double samples =
      std::max({std::ceil(std::log(kFalseAlarms) / std::log(same)), kStuckAtLeast_s * rate_hz, 3.0});
  return samples > kFoundWithin_s * rate_hz ? 0 : static_cast<std::uint64_t>(samples);
}

// The window and the deviation below which it is no honest noise, by the chi-square distribution (Wilson and
// Hilferty's cube).
void SetFlat(const RawLimits& limits, double rate_hz, WatchAbility& ability) {
  if (!(limits.noise > 0) || limits.noise < kLeastNoiseForFlatInQuanta * limits.quantum) return;
  // The fault may begin within a window; the next whole one then ends in time.
  const double samples =
      std::max(std::floor(kFlatWindow_s * rate_hz), std::min(40.0, std::floor(kFoundWithin_s * rate_hz / 2)));
  const double freedom = samples - 1;
  const double root = 1 - 2 / (9 * freedom) - kFlatSigmas * std::sqrt(2 / (9 * freedom));
  if (!(root > 0)) return;
  const double below = std::min(std::pow(root, 1.5), kFlattest) * limits.noise;
  ability.flat_window = static_cast<std::uint64_t>(samples);
  ability.flat_below = below;
}

bool IsOutside(double value, const std::optional<double>& least, const std::optional<double>& most) {
  return (least && value < *least) || (most && value > *most);
}

}  // namespace

SensorWatch::SensorWatch(const SourceDescription& source)
    : source_(source), channels_(source.channels.size()) {
  if (!(source.rate_hz > 0))
    throw std::invalid_argument(fmt::format("rate_hz = {} is not above zero", source.rate_hz));
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const RawLimits& limits = source.channels[i].limits;
    channels_[i].ability.stuck_after = StuckAfter(limits, source.rate_hz);
    SetFlat(limits, source.rate_hz, channels_[i].ability);
  }
}

void SensorWatch::Measure(Channel& channel, double value) const noexcept {
  if (channel.ability.flat_window == 0) return;
  const double n = static_cast<double>(++channel.in_window);
  const double change = value - channel.window_mean;
  channel.window_mean += change / n;
  channel.window_squares += change * (value - channel.window_mean);
  if (channel.in_window < channel.ability.flat_window) return;
  channel.deviation = std::sqrt(channel.window_squares / (n - 1));
  channel.is_flat = channel.deviation < channel.ability.flat_below;
  channel.in_window = 0;
  channel.window_mean = channel.window_squares = 0;
}

SensorFault SensorWatch::FaultOf(Channel& channel, const RawLimits& limits, std::uint32_t word,
                                 double value) const noexcept {
  const bool same = channel.has_last && word == channel.last_word;
  channel.same = same ? channel.same + 1 : 1;
  channel.last_word = word;
  channel.has_last = true;
  if (!std::isfinite(value)) return SensorFault::kNotFinite;
  Measure(channel, value);
  const bool at_end = (limits.saturation_high && value >= *limits.saturation_high) ||
                      (limits.saturation_low && value <= *limits.saturation_low);
  channel.saturated = at_end ? channel.saturated + 1 : 0;
  channel.outside = IsOutside(value, limits.least, limits.most) ? channel.outside + 1 : 0;
  // The end of the converter explains more than the one value at which the channel then stands.
  if (channel.saturated >= kInARow) return SensorFault::kSaturated;
  if (channel.ability.stuck_after > 0 && channel.same >= channel.ability.stuck_after)
    return SensorFault::kStuck;
  if (channel.outside >= kInARow) return SensorFault::kOutOfRange;
  if (channel.is_flat) return SensorFault::kFlat;
  return SensorFault::kNone;
}

void SensorWatch::Raise(Channel& channel, SensorFault fault, double evidence) noexcept {
  channel.good_samples = 0;
  if (fault < channel.fault) return;
  channel.fault = fault;
  channel.evidence = evidence;
}

// The device's own times against its own count: neither jitter nor drift against this machine enters.
bool SensorWatch::TimeSteps(const BlockHeader& header, double& step_s) noexcept {
  const std::optional<BlockHeader> last = std::exchange(last_, header);
  if (!last || (header.flags & (kAfterReset | kLostIsEstimate)) != 0) return false;
  // A device without a clock of its own says zero each time.
  if (header.device_time.count() == 0 && last->device_time.count() == 0) return false;
  const double samples = static_cast<double>(header.first_sample - last->first_sample);
  step_s = std::chrono::duration<double>(header.device_time - last->device_time).count() -
           samples / source_.rate_hz;
  // A rate that is off by 1 in 1000 is not a step.
  const double allowed_s =
      std::max(kLeastTimeStep_s, kTimeStepInSamples / source_.rate_hz) + 1e-3 * samples / source_.rate_hz;
  return std::abs(step_s) > allowed_s;
}

void SensorWatch::Judge(const SampleBlock& block) noexcept {
  const BlockHeader& header = block.header;
  if (header.samples == 0 || header.channels != channels_.size()) return;
  last_arrival_ = header.arrival;
  has_arrived_ = true;
  double step_s = 0;
  const bool time_steps = TimeSteps(header, step_s);
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    Channel& channel = channels_[c];
    // What silence said is over with the first sample.
    if (channel.fault == SensorFault::kSilent) channel.fault = SensorFault::kNone;
    if (time_steps) Raise(channel, SensorFault::kTimeSteps, step_s);
    for (std::size_t i = 0; i < header.samples; ++i) {
      const std::uint32_t word = block.words()[i * header.channels + c];
      const double value = SampleBlock::ValueOf(word, header.type);
      const SensorFault fault = FaultOf(channel, source_.channels[c].limits, word, value);
      if (fault != SensorFault::kNone) {
        Raise(channel, fault, fault == SensorFault::kFlat ? channel.deviation : value);
      } else if (channel.fault != SensorFault::kNone &&
                 ++channel.good_samples >= kGoodAfter_s * source_.rate_hz) {
        channel.fault = SensorFault::kNone;
      }
    }
  }
}

void SensorWatch::Tick(std::chrono::nanoseconds now) noexcept {
  if (!has_arrived_) {
    last_arrival_ = now;
    has_arrived_ = true;
  }
  const double silent_s = std::chrono::duration<double>(now - last_arrival_).count();
  if (silent_s < kSilentAfter_s) return;
  for (Channel& channel : channels_) Raise(channel, SensorFault::kSilent, silent_s);
}

bool SensorWatch::is_good() const {
  return std::all_of(channels_.begin(), channels_.end(),
                     [](const Channel& channel) { return channel.fault == SensorFault::kNone; });
}

std::string SensorWatch::ReasonOf(std::size_t index) const {
  const Channel& channel = channels_[index];
  const ChannelDescription& description = source_.channels[index];
  const RawLimits& limits = description.limits;
  const std::string who = description.sensor_serial.empty()
                              ? description.name
                              : fmt::format("{} (sensor {})", description.name, description.sensor_serial);
  const std::string value = ShortestText(static_cast<float>(channel.evidence));
  switch (channel.fault) {
    case SensorFault::kNone:
      return {};
    case SensorFault::kTimeSteps:
      return fmt::format("{} steps in time: the device's clock moved {:.6g} s against its samples", who,
                         channel.evidence);
    case SensorFault::kFlat:
      return fmt::format("{} is flat: noise {:.3g}, {:.3g} with nothing to measure", who, channel.evidence,
                         limits.noise);
    case SensorFault::kOutOfRange:
      return fmt::format("{} is out of range: {} (expected {} to {})", who, value,
                         limits.least ? ShortestText(*limits.least) : "any",
                         limits.most ? ShortestText(*limits.most) : "any");
    case SensorFault::kSaturated:
      return fmt::format("{} is saturated: {} is an end of the converter", who, value);
    case SensorFault::kStuck:
      return fmt::format("{} is stuck: {} for {:.2f} s", who, value,
                         static_cast<double>(channel.same) / source_.rate_hz);
    case SensorFault::kNotFinite:
      return fmt::format("{} gives {}, which is no number", who, channel.evidence);
    case SensorFault::kSilent:
      return fmt::format("{} is silent: nothing came for {:.1f} s", who, channel.evidence);
  }
  return {};
}

std::string SensorWatch::BlindSpotsOf(std::size_t index) const {
  const ChannelDescription& description = source_.channels[index];
  const RawLimits& limits = description.limits;
  std::string blind;
  const auto add = [&blind](const char* what) { blind += (blind.empty() ? "" : ", ") + std::string(what); };
  if (channels_[index].ability.stuck_after == 0) add("a stuck value");
  if (channels_[index].ability.flat_window == 0) add("a flat line");
  if (!limits.saturation_low || !limits.saturation_high) add("saturation");
  if (!limits.least || !limits.most) add("a value out of range");
  if (blind.empty()) return {};
  return fmt::format("{} cannot be told from a good sensor within {} s: {}", description.name, kFoundWithin_s,
                     blind);
}

}  // namespace strainwave::daq::acquisition
