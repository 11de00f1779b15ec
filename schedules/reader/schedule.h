// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "schedules/reader/findings.h"

namespace strainwave::schedules {

/// What is tested. SI inside; the file carries units in the text.
struct Specimen {
  std::string identity;  // serial number on the unit
  std::string model;
  double ratio{};  // signed
  double t1_Nm{}, t2_Nm{}, t3_Nm{};
  double rated_torque_Nm{};
  double rated_speed_rad_per_s{};  // at the input, the speed that the rated torque holds for
  double bearing_l10_s{};          // life of the wave-generator bearing at rated torque and speed
  double ratcheting_torque_Nm{};   // tooth jumping
  double buckling_torque_Nm{};
  int flexspline_teeth{};
  int circular_spline_teeth{};
};

/// Watched in every phase; tripping one stops the bench.
struct Limits {
  double output_torque_Nm{};
  double input_speed_rad_per_s{};
  double gear_temperature_degC{};
  double vibration_rms_m_per_s2{};
  double twist_rad{};  // only while the input is locked
};

/// Threshold pair with dwell: the run is suspended above `trip` and goes on after `dwell_s` below `resume`.
struct SuspendRule {
  double trip_temperature_degC{};
  double resume_temperature_degC{};
  double dwell_s{};
  double bad_sensor_s{};  // a channel bad for this long suspends; good for dwell_s resumes
  double give_up_s{};     // suspended for longer ends the run with a fault
};

/// How long a servo may take to reach a set point that stands, and its measuring chain to show it.
inline constexpr double kSettlesWithin_s = 0.4;

/// How far transducer and encoder may be from what a phase asks for. Load that is further away is not
/// credited, and a phase that is away for longer than the dwell ends with a fault.
struct SetPointTolerances {
  double torque_share{0.15};  // of the torque asked for, at least of the specimen's rated torque / 3
  double speed_share{0.05};   // of the speed asked for
  double dwell_s{2.0};
};

/// Repeated: `turns` of the output clockwise, then counter-clockwise, at constant input speed under load.
struct LoadRun {
  double duration_s{};
  double output_torque_Nm{};
  double input_speed_rad_per_s{};
  double turns{1.0};
  double input_acceleration_rad_per_s2{};
  double torque_rate_Nm_per_s{};
  double log_rate_hz{1.0};
  double vibration_statistics_hz{};  // sample rate of RMS, peak, crest factor and kurtosis; 0: none
  SetPointTolerances tolerances;
};

/// Rotation of the output in one direction with raw vibration.
struct MeasurementRotation {
  double turns{1.0};
  bool clockwise{true};
  double input_speed_rad_per_s{};
  double output_torque_Nm{};
  double input_acceleration_rad_per_s2{};
  double log_rate_hz{100.0};  // of the slow channels; the vibration is kept at its own rate
  double vibration_rate_hz{25600.0};
  SetPointTolerances tolerances;
};

/// Stepwise rotation of the output with both angles read at standstill, one direction after the other.
struct TransmissionErrorSweep {
  double step_rad{};  // of the output
  int steps{360};
  bool clockwise{true};
  bool counter_clockwise{true};
  double input_speed_rad_per_s{};
  double input_acceleration_rad_per_s2{};
  double settle_s{};     // standstill before the readings
  double averaging_s{};  // readings averaged at each step
};

/// Input brake locked, torque ramped 0 → +T → −T → +T → 0, at each lock angle of the wave generator.
struct HysteresisTest {
  double peak_torque_Nm{};
  double torque_rate_Nm_per_s{};
  double hold_s{};  // at each peak
  double loops{1.0};
  double log_rate_hz{50.0};
  std::vector<double> lock_angles_rad;  // input angles; several average out docs/effects.md E7
};

/// Standstill until the gear is below a temperature, or for a time: the soak that declares a thermal state.
struct Soak {
  double below_temperature_degC{};
  double at_most_s{};
};

/// The input replaced by a rigid blank: torque ramp for the series compliance, slow turn for the encoder's
/// eccentricity. Run before the first cycle, with the operator's word that the blank is mounted.
struct BlankTest {
  double peak_torque_Nm{};
  double torque_rate_Nm_per_s{};
  int steps{72};  // of the turn
};

/// Reads a sensor at standstill, torque off, where what it should read is known (docs/requirements.md R35).
struct SensorCheck {
  enum class Kind {
    kZero,       // the torque transducer without torque
    kShunt,      // what a known resistor across its bridge adds to that
    kReference,  // both encoders against each other, as they stood in the first cycle
  };
  Kind kind{};
  double expected_Nm{};  // of the shunt, by its certificate
  double allowed{};      // distance from what is expected: Nm; of the encoders rad at the output
  double most_noise{};   // standard deviation of the readings, same unit
  double duration_s{};   // of readings
  bool stops{true};      // beyond the limit: stop; else the result is marked, and the campaign goes on
};

using PhaseParameters = std::variant<LoadRun, MeasurementRotation, TransmissionErrorSweep, HysteresisTest,
                                     Soak, BlankTest, SensorCheck>;

struct Phase {
  std::string name;
  PhaseParameters parameters;
  int line{};  // in the schedule file
  /// Devices of the bench file whose raw samples are kept while the phase runs.
  std::vector<std::string> recorded_sources{};
};

/// The text in the file that selects a phase's kind ("load_run", "hysteresis", …).
std::string KindName(const PhaseParameters& parameters);

/// Ends the campaign when met; `failure` decides between exit code 0 and 1.
struct StopCriteria {
  std::optional<double> k2_below_share_of_first;
  std::optional<double> e_max_above_rad;
  std::optional<double> vibration_rms_above_m_per_s2;
};

enum class OnFailedCheck { kStoreFlagged, kStop };

/// A measurement whose checks fail, or that the control chart calls an outlier, is taken again.
struct MeasurementRules {
  int retries{1};
  OnFailedCheck on_failed_check{OnFailedCheck::kStoreFlagged};
  int repeatability_repeats{5};        // measurements repeated before the first cycle; 0: none
  double declared_temperature_degC{};  // measurement state: mid …
  double temperature_tolerance_K{};    // … and half width; outside it the results are flagged
};

/// What counts as the same test after a pause (docs/requirements.md R53).
struct ResumeRules {
  double longest_pause_s{};      // longer needs --accept-pause
  double re_soak_after_s{};      // a pause longer than this warms up again before measuring
  bool operator_acknowledges{};  // resume asks before anything moves (R10)
  int unattended{};              // times in a row that a run that was cut may go on without a person
};

struct Schedule {
  std::string name;
  Specimen specimen;
  Limits limits;
  SuspendRule suspend;
  int cycles{};
  std::vector<Phase> preparation;  // once, before the first cycle
  std::vector<Phase> phases;       // every cycle, in this order
  StopCriteria stop;
  MeasurementRules measurements;
  ResumeRules resume;

  std::string file_name;  // as given to the reader; empty for a schedule made in code
  Origins origins;  // where each value stood, for messages: "limits.output_torque", "phases[0].duration"
};

}  // namespace strainwave::schedules
