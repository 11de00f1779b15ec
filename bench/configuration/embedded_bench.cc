// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/embedded_bench.h"

#include "bench/configuration/read_bench_file.h"

namespace strainwave::bench {

const std::string& EmbeddedBenchText() {
  static const std::string text = R"(# The simulated bench that is used when no other is given.
bench: 1
name: embedded simulated bench
simulated: true
control_period: 10 ms
fast_control_period: 1 ms          # while a measurement rotation asks for a higher log rate
vibration_rate: 51.2 kHz           # the highest; a schedule asks for what it needs

driving_servo:                     # 750 W, with a holding brake
  serial: SIM-DRIVE
  peak_torque: 7.16 Nm
  peak_speed: 6000 rpm
  max_acceleration: 5000 rad/s2

load_servo:                        # the same motor, behind a planetary reducer
  serial: SIM-LOAD
  peak_torque: 7.16 Nm
  peak_speed: 6000 rpm
  max_acceleration: 5000 rad/s2
load_reducer_ratio: 70

torque_transducer:
  serial: SIM-TORQUE
  range: 100 Nm
  linearity: 0.3 %                 # of the range
  gain_uncertainty: 0.05 %         # what calibration leaves, one standard deviation
  calibration: SIM-CAL-TORQUE

input_encoder:                     # at the motor shaft
  serial: SIM-INPUT
  counts_per_rev: 1048576
  accuracy: 20 arcsec
  calibration: SIM-CAL-INPUT
  sign: 1

output_encoder:                    # at the output of the gear
  serial: SIM-OUTPUT
  counts_per_rev: 268435456
  accuracy: 2.5 arcsec
  calibration: SIM-CAL-OUTPUT
  sign: 1

blank_reference_accuracy: 0.5 arcsec   # of the encoder on the blank that the output encoder is held against

accelerometers:
  - {name: accel_x, serial: SIM-ACC-X, sensitivity: 100 mV/g, range: 50 g, calibration: SIM-CAL-X}
  - {name: accel_y, serial: SIM-ACC-Y, sensitivity: 100 mV/g, range: 50 g, calibration: SIM-CAL-Y}
  - {name: accel_z, serial: SIM-ACC-Z, sensitivity: 100 mV/g, range: 50 g, calibration: SIM-CAL-Z}
  - {name: accel_motor_z, serial: SIM-ACC-M, sensitivity: 100 mV/g, range: 50 g, calibration: SIM-CAL-M}

simulation:
  seed: 1
  time_skew: 0 s                   # by which the output encoder is read late
  write_truth: false
  plant: []                        # what differs from the nominal plant, as in
                                   #   - {term: creep, enabled: false}
                                   #   - {term: kinematic_input_2, parameters: {amplitude_rad: 2e-4}}
)";
  return text;
}

BenchDescription EmbeddedBench() { return ParseBenchFile(EmbeddedBenchText(), "embedded bench"); }

}  // namespace strainwave::bench
