// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/alarms/alarm_rules.h"
#include "bench/configuration/device_descriptions.h"
#include "daq/acquisition/calibration.h"
#include "schedules/reader/findings.h"

namespace strainwave::bench {

/// A servo drive and its motor, at the motor's shaft.
struct ServoDescription {
  std::string serial;
  double peak_torque_Nm{};
  double peak_speed_rad_per_s{};
  double max_acceleration_rad_per_s2{};
  DriveLink drive;  // of a bench that is not simulated
};

/// The transducer between the gear and the load.
struct TransducerDescription {
  std::string serial;
  std::string calibration;      // id of the certificate
  std::string calibration_due;  // YYYY-MM-DD
  double range_Nm{};            // in either direction
  double relative_linearity{};  // of the range
  /// Standard uncertainty of the gain that calibration leaves, relative.
  double relative_gain_uncertainty{};
  SwitchLink shunt;  // connects the resistor of the shunt check
  /// Of the sensor's own data sheet, where the file has that: goes before what a device says.
  std::optional<daq::acquisition::Calibration> teds;
};

/// A measuring encoder; `sign` is −1 when it counts against the bench's positive direction.
struct EncoderDescription {
  std::string serial;
  std::string calibration;
  std::string calibration_due;
  std::int64_t counts_per_rev{};
  double accuracy_rad{};
  int sign{1};
};

struct AccelerometerDescription {
  std::string name;  // "accel_x": of the channel that it feeds
  std::string serial;
  std::string calibration;
  std::string calibration_due;
  double sensitivity_V_per_m_per_s2{};
  double range_m_per_s2{};
  std::optional<daq::acquisition::Calibration> teds;  // as of the transducer
};

/// One term of the simulated plant. Which names and parameters there are is the plant's to say.
struct TermDescription {
  std::string name;
  bool enabled{true};
  std::vector<std::pair<std::string, double>> parameters;  // in file order
  int line{};
};

/// Of a simulated bench, and of the device side that stands in for a real one (`strainwave-devices`).
struct SimulationDescription {
  std::uint64_t seed{};
  double time_skew_s{};                // by which the output encoder is read late (docs/effects.md E20)
  bool write_truth{};                  // what no bench can measure, to a file beside the campaign
  std::string plant_file;              // as written; empty when the terms stand in the bench file itself
  std::vector<TermDescription> terms;  // of the bench file or of `plant_file`
};

/// What a bench consists of, SI inside. The defaults of the file are in
/// bench/configuration/read_bench_file.cc.
struct BenchDescription {
  std::string name;
  bool simulated{};
  double control_period_s{};
  /// The shortest period that the bench can keep, for a phase that asks to be logged faster than the usual
  /// one.
  double fast_control_period_s{};
  double stale_after_s{};      // how old readings may become before the bench stops
  double longest_stop_s{};     // in which the drives must stand once this program is gone
  double vibration_rate_hz{};  // highest sample rate of the accelerometers
  ServoDescription driving_servo;
  ServoDescription load_servo;
  double load_reducer_ratio{};  // between load servo and transducer
  TransducerDescription transducer;
  EncoderDescription input_encoder;
  EncoderDescription output_encoder;
  /// Half width of the error of the angle that the blank test holds the output encoder against.
  double blank_reference_accuracy_rad{};
  std::vector<AccelerometerDescription> accelerometers;
  std::vector<DeviceDescription> devices;  // none where the bench is simulated
  std::vector<ChannelLink> channels;
  SimulationDescription simulation;
  std::vector<AlarmRule> alarms;  // what the bench file says of kinds of alarms

  std::string file_name;  // as given to the reader
  schedules::Origins origins;
};

/// Time between the readings of a transmission-error sweep: on metal short enough to follow the output as it
/// swings on the gear's spring, for the time between the encoders to be told (EncoderSkew). A simulated bench
/// that is asked less often than each 2 ms does not swing.
inline double SweepPeriod_s(const BenchDescription& bench) {
  constexpr double kFollowsSwing_s = 4e-3;
  if (bench.simulated) return bench.control_period_s;
  return std::min(bench.control_period_s, std::max(bench.fast_control_period_s, kFollowsSwing_s));
}

}  // namespace strainwave::bench
