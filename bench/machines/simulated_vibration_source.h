// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "bench/configuration/bench_description.h"
#include "bench/roles/bench_machine.h"
#include "bench/roles/vibration_source.h"

namespace strainwave::bench {

struct SimulatedStream {
  double input_speed_rad_per_s{};
  double output_torque_Nm{};
  double ratio{80.0};
  double sample_rate_hz{};
  double duration_s{};      // of the stream, after the run-up
  double pace{1.0};         // times real time; infinity: as fast as it can
  std::int64_t start_ns{};  // time of the beginning, since 1970, UTC
};

/// The accelerometers of a simulated bench that turns at one speed under one torque, clockwise, with the
/// torques of motor and output and the temperature of the gear.
class SimulatedVibrationSource final : public VibrationSource {
 public:
  /// @throws BenchError for a bench that is not simulated, or drives that do not come up.
  SimulatedVibrationSource(const BenchDescription& description, const SimulatedStream& stream);
  ~SimulatedVibrationSource() override;

  Got Next(std::chrono::milliseconds patience, VibrationChunk& chunk) override;
  std::int64_t NowNanoseconds() const override;

 private:
  void RunUp();
  void Advance();

  SimulatedStream stream_;
  std::unique_ptr<BenchMachine> machine_;
  BenchDevices devices_;
  std::chrono::nanoseconds began_{};
  std::uint64_t samples_{};
  Readings last_;
};

}  // namespace strainwave::bench
