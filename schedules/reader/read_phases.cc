// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/read_phases.h"

#include <utility>

namespace strainwave::schedules {
namespace {

constexpr int kMostSteps = 1'000'000;
// What the fit of the encoder's error wants of a turn; a blank test with fewer would be lost at its end.
constexpr int kFewestBlankSteps = 16;

// Defaults that several kinds share.
constexpr std::string_view kInputAcceleration = "1000 rad/s2";
constexpr std::string_view kTorqueRate = "40 Nm/s";

double ReadInputSpeed(YamlMap& map) {
  return map.Quantity("input_speed", Dimension::kAngularSpeed, Bound::kPositive);
}

double ReadInputAcceleration(YamlMap& map) {
  return map.Quantity("input_acceleration", Dimension::kAngularAcceleration, Bound::kPositive,
                      kInputAcceleration);
}

double ReadOutputTorque(YamlMap& map) {
  return map.Quantity("output_torque", Dimension::kTorque, Bound::kNotNegative);
}

double ReadLogRate(YamlMap& map, std::string_view default_text) {
  return map.Quantity("log_rate", Dimension::kFrequency, Bound::kPositive, default_text);
}

// The torque of a strain-wave gear ripples, and friction behind the load servo takes its share; a speed is
// held to a per cent.
SetPointTolerances ReadTolerances(YamlMap& map) {
  SetPointTolerances tolerances;
  tolerances.torque_share = map.Quantity("torque_tolerance", Dimension::kShare, Bound::kPositive, "15 %");
  tolerances.speed_share = map.Quantity("speed_tolerance", Dimension::kShare, Bound::kPositive, "5 %");
  tolerances.dwell_s = map.Quantity("tolerance_dwell", Dimension::kTime, Bound::kPositive, "2 s");
  return tolerances;
}

LoadRun ReadLoadRun(YamlMap& map) {
  LoadRun run;
  run.duration_s = map.Quantity("duration", Dimension::kTime, Bound::kPositive);
  run.output_torque_Nm = ReadOutputTorque(map);
  run.input_speed_rad_per_s = ReadInputSpeed(map);
  run.turns = map.Number("turns", Bound::kPositive, "1");
  run.input_acceleration_rad_per_s2 = ReadInputAcceleration(map);
  run.torque_rate_Nm_per_s =
      map.Quantity("torque_rate", Dimension::kTorqueRate, Bound::kPositive, kTorqueRate);
  run.log_rate_hz = ReadLogRate(map, "1 Hz");
  run.vibration_statistics_hz =
      map.OptionalQuantity("vibration_statistics", Dimension::kFrequency, Bound::kPositive).value_or(0.0);
  run.tolerances = ReadTolerances(map);
  return run;
}

MeasurementRotation ReadMeasurementRotation(YamlMap& map) {
  MeasurementRotation rotation;
  rotation.turns = map.Number("turns", Bound::kPositive, "1");
  rotation.clockwise = map.Choice<bool>("direction", {{"cw", true}, {"ccw", false}}, "cw");
  rotation.input_speed_rad_per_s = ReadInputSpeed(map);
  rotation.output_torque_Nm = ReadOutputTorque(map);
  rotation.input_acceleration_rad_per_s2 = ReadInputAcceleration(map);
  rotation.log_rate_hz = ReadLogRate(map, "100 Hz");
  rotation.vibration_rate_hz =
      map.Quantity("vibration_rate", Dimension::kFrequency, Bound::kPositive, "25.6 kHz");
  rotation.tolerances = ReadTolerances(map);
  return rotation;
}

TransmissionErrorSweep ReadTransmissionErrorSweep(YamlMap& map) {
  enum class Directions { kBoth, kClockwise, kCounterClockwise };
  TransmissionErrorSweep sweep;
  sweep.step_rad = map.Quantity("step", Dimension::kAngle, Bound::kPositive, "1 deg");
  sweep.steps = map.Count("steps", 1, kMostSteps, "360");
  const Directions directions = map.Choice<Directions>(
      "directions",
      {{"both", Directions::kBoth}, {"cw", Directions::kClockwise}, {"ccw", Directions::kCounterClockwise}},
      "both");
  sweep.clockwise = directions != Directions::kCounterClockwise;
  sweep.counter_clockwise = directions != Directions::kClockwise;
  sweep.input_speed_rad_per_s = ReadInputSpeed(map);
  sweep.input_acceleration_rad_per_s2 = ReadInputAcceleration(map);
  sweep.settle_s = map.Quantity("settle", Dimension::kTime, Bound::kNotNegative, "0.1 s");
  sweep.averaging_s = map.Quantity("averaging", Dimension::kTime, Bound::kPositive, "0.05 s");
  return sweep;
}

HysteresisTest ReadHysteresisTest(YamlMap& map) {
  HysteresisTest test;
  test.peak_torque_Nm = map.Quantity("peak_torque", Dimension::kTorque, Bound::kPositive);
  test.torque_rate_Nm_per_s = map.Quantity("torque_rate", Dimension::kTorqueRate, Bound::kPositive, "3 Nm/s");
  test.hold_s = map.Quantity("hold", Dimension::kTime, Bound::kNotNegative, "0.5 s");
  test.loops = map.Count("loops", 1, 1000, "1");
  test.log_rate_hz = ReadLogRate(map, "50 Hz");
  test.lock_angles_rad = map.QuantityList("lock_angles", Dimension::kAngle, Bound::kAny, "0 deg");
  return test;
}

Soak ReadSoak(YamlMap& map) {
  Soak soak;
  soak.below_temperature_degC = map.Quantity("below_temperature", Dimension::kTemperature, Bound::kAny);
  soak.at_most_s = map.Quantity("at_most", Dimension::kTime, Bound::kPositive);
  return soak;
}

BlankTest ReadBlankTest(YamlMap& map) {
  BlankTest test;
  test.peak_torque_Nm = map.Quantity("peak_torque", Dimension::kTorque, Bound::kPositive);
  test.torque_rate_Nm_per_s = map.Quantity("torque_rate", Dimension::kTorqueRate, Bound::kPositive, "3 Nm/s");
  test.steps = map.Count("steps", kFewestBlankSteps, kMostSteps, "72");
  return test;
}

SensorCheck ReadSensorCheck(YamlMap& map, SensorCheck::Kind kind) {
  const bool torque = kind != SensorCheck::Kind::kReference;
  const Dimension dimension = torque ? Dimension::kTorque : Dimension::kAngle;
  SensorCheck check;
  check.kind = kind;
  if (kind == SensorCheck::Kind::kShunt) {
    check.expected_Nm = map.Quantity("expected", Dimension::kTorque, Bound::kNotZero);
  }
  check.allowed = map.Quantity("allowed", dimension, Bound::kPositive);
  check.most_noise = map.Quantity("noise", dimension, Bound::kPositive, torque ? "0.5 Nm" : "1 arcmin");
  check.duration_s = map.Quantity("duration", Dimension::kTime, Bound::kPositive, "2 s");
  check.stops = map.Choice<bool>("on_failure", {{"stop", true}, {"mark", false}}, "stop");
  return check;
}

template <SensorCheck::Kind kind>
PhaseParameters ReadCheck(YamlMap& map) {
  return ReadSensorCheck(map, kind);
}

PhaseParameters ReadParameters(YamlMap& map) {
  using ReadKind = PhaseParameters (*)(YamlMap&);
  const auto read = map.Choice<ReadKind>(
      "kind",
      {{"load_run", [](YamlMap& m) { return PhaseParameters{ReadLoadRun(m)}; }},
       {"measurement_rotation", [](YamlMap& m) { return PhaseParameters{ReadMeasurementRotation(m)}; }},
       {"transmission_error", [](YamlMap& m) { return PhaseParameters{ReadTransmissionErrorSweep(m)}; }},
       {"hysteresis", [](YamlMap& m) { return PhaseParameters{ReadHysteresisTest(m)}; }},
       {"soak", [](YamlMap& m) { return PhaseParameters{ReadSoak(m)}; }},
       {"blank_test", [](YamlMap& m) { return PhaseParameters{ReadBlankTest(m)}; }},
       {"zero_check", ReadCheck<SensorCheck::Kind::kZero>},
       {"shunt_check", ReadCheck<SensorCheck::Kind::kShunt>},
       {"reference_check", ReadCheck<SensorCheck::Kind::kReference>}});
  if (map.is_wrong("kind")) return {};
  return read(map);
}

}  // namespace

std::vector<Phase> ReadPhases(std::vector<YamlMap> maps) {
  std::vector<Phase> phases;
  for (YamlMap& map : maps) {
    Phase phase;
    phase.line = map.line();
    phase.parameters = ReadParameters(map);
    const bool kind_is_known = !map.is_wrong("kind");
    phase.name = map.Identifier("name", kind_is_known ? KindName(phase.parameters) : "unknown");
    phase.recorded_sources = map.TextList("record");
    // Without a kind there is no telling which other keys belong here.
    map.Finish(kind_is_known ? OtherKeys::kRefused : OtherKeys::kUncertain);
    phases.push_back(std::move(phase));
  }
  return phases;
}

}  // namespace strainwave::schedules
