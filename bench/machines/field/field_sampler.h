// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/machines/field/source_reader.h"
#include "bench/roles/bench_clock.h"
#include "bench/roles/channel_value.h"
#include "bench/roles/sampler.h"

namespace strainwave::bench {

/// Where each slow channel of the bench comes from. A function returns at once and never throws; its value is
/// in SI. Angles and torque must be there; speed, motor torque, and ambient temperature may be nothing.
struct FieldChannels {
  using Read = std::function<ChannelValue()>;

  std::array<Read, 8> channels;  // by `Channel`
  /// Accelerometers in the order of VibrationBlock, all of one source; nothing where there is none.
  SourceReader* vibration{};
  std::array<std::optional<std::size_t>, 4> accelerometers;
  std::function<bool()> quick_stop_pressed;  // nothing: the bench has no key
  std::function<void()> mark_trip;           // of all sources; nothing: there are none
  std::function<void(bool)> connect_shunt;   // of the torque transducer; nothing: it has none
};

/// The measuring side of a bench of metal: the newest value of every channel from whichever device has it,
/// with the time when it was sampled.
class FieldSampler final : public Sampler {
 public:
  /// @throws std::invalid_argument for a channel of angle, torque or gear temperature that is nothing.
  FieldSampler(FieldChannels channels, const BenchClock& clock);

  Readings Read() noexcept override;
  void StartVibration(double sample_rate_hz) override;
  void StopVibration() override;
  void DrainVibration(VibrationBlock& block) override;
  void MarkTrip() override {
    if (channels_.mark_trip) channels_.mark_trip();
  }
  void ConnectShunt(bool on) noexcept override {
    if (channels_.connect_shunt) channels_.connect_shunt(on);
  }

 private:
  FieldChannels channels_;
  const BenchClock& clock_;
};

/// The factor from the unit that a channel's name ends in to SI: "input_angle_deg", "torque_Nm".
/// @throws std::invalid_argument for a name without one.
double SiFactor(std::string_view channel_name);

}  // namespace strainwave::bench
