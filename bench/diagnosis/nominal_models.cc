// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/nominal_models.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/diagnosis/make_study.h"

namespace strainwave::bench {
namespace {

using daq::Direction;
using daq::Record;

constexpr double kRatio = 80.0;
constexpr double kStiffness_Nm_per_rad = 2.0e4;
constexpr double kRoom_degC = 22.0;
constexpr double kWarming_K = 3.0;

void AddColumn(Record& record, std::string name, daq::Column::Values values) {
  record.columns.push_back({std::move(name), std::move(values), "", ""});
}

// As a bench warms up that was cold: most of it in the first third.
void AddTemperature(Record& record, const std::vector<double>& time_s) {
  std::vector<double> temperature_degC;
  for (const double time : time_s) {
    temperature_degC.push_back(kRoom_degC - kWarming_K * std::expm1(-3.0 * time / time_s.back()));
  }
  AddColumn(record, "temperature_degC", std::move(temperature_degC));
}

Record Sweep(const ExcitationColumns& columns) {
  constexpr int kSteps = 360;
  constexpr double kPeriod_s = 0.5;
  std::vector<Direction> direction;
  std::vector<double> time_s, input_deg, output_deg, torque_Nm;
  for (const Direction way : {Direction::kClockwise, Direction::kCounterClockwise}) {
    for (int k = 0; k <= kSteps; ++k) {
      const double angle_deg = way == Direction::kClockwise ? k : kSteps - k;
      direction.push_back(way);
      time_s.push_back(kPeriod_s * static_cast<double>(time_s.size()));
      input_deg.push_back(kRatio * angle_deg);
      output_deg.push_back(angle_deg -
                           DegFromRad(RadFromArcmin(0.5 * std::cos(2.0 * RadFromDeg(kRatio * angle_deg)))));
      // A load that leaves angle, direction and time alone.
      torque_Nm.push_back(8.0 * std::sin(0.37 * time_s.back()));
    }
  }
  Record record{.kind = daq::RecordKind::kTransmissionError, .metadata = {}, .columns = {}, .source = {}};
  record.SetMetadata("ratio", kRatio);
  const std::vector<double> time = time_s;
  AddColumn(record, "time_s", std::move(time_s));
  AddColumn(record, "direction", std::move(direction));
  AddColumn(record, "input_angle_deg", std::move(input_deg));
  AddColumn(record, "output_angle_deg", std::move(output_deg));
  if (columns.torque) AddColumn(record, "torque_Nm", std::move(torque_Nm));
  if (columns.temperature) AddTemperature(record, time);
  return record;
}

Record Loops(const ExcitationColumns& columns) {
  constexpr double kPeak_Nm = 34.0;
  constexpr double kRate_Nm_per_s = 1.0;
  constexpr double kPeriod_s = 0.1;
  constexpr double kHold_s = 5.0;
  std::vector<double> time_s, torque_Nm, output_deg;
  double torque = 0.0;
  const auto add = [&] {
    time_s.push_back(kPeriod_s * static_cast<double>(time_s.size()));
    torque_Nm.push_back(torque);
    output_deg.push_back(DegFromRad(torque / kStiffness_Nm_per_rad));
  };
  for (const double target : {kPeak_Nm, -kPeak_Nm, kPeak_Nm, -kPeak_Nm, 0.0}) {
    const double step = std::copysign(kRate_Nm_per_s * kPeriod_s, target - torque);
    for (; std::abs(target - torque) > 0.5 * std::abs(step); torque += step) add();
    torque = target;
    for (double held_s = 0.0; held_s < kHold_s; held_s += kPeriod_s) add();
  }
  Record record{.kind = daq::RecordKind::kHysteresis, .metadata = {}, .columns = {}, .source = {}};
  for (const auto& [key, value] : {std::pair{"t1_Nm", 7.0}, {"t2_Nm", 25.0}, {"t3_Nm", kPeak_Nm}}) {
    record.SetMetadata(key, value);
  }
  const std::vector<double> time = time_s;
  AddColumn(record, "time_s", std::move(time_s));
  AddColumn(record, "torque_Nm", std::move(torque_Nm));
  AddColumn(record, "output_angle_deg", std::move(output_deg));
  if (columns.temperature) AddTemperature(record, time);
  return record;
}

Record MultiSine(const ExcitationColumns& columns) {
  constexpr double kRate_hz = 1000.0;
  constexpr double kDuration_s = 20.0;
  // Incommensurate, so that speed, position and acceleration go their own ways.
  constexpr struct {
    double amplitude_rad, frequency_hz, phase_rad;
  } kSines[] = {{8.0, 0.11, 0.3}, {2.0, 0.37, 1.1}, {0.5, 1.3, 2.0}, {0.08, 4.1, 0.7}};
  std::vector<double> time_s, position_rad, velocity_rad_per_s, torque_Nm;
  for (int k = 0; k < static_cast<int>(kDuration_s * kRate_hz); ++k) {
    const double time = k / kRate_hz;
    double position = 0.0, velocity = 0.0, acceleration = 0.0;
    for (const auto& sine : kSines) {
      const double omega = kTwoPi * sine.frequency_hz;
      position += sine.amplitude_rad * std::sin(omega * time + sine.phase_rad);
      velocity += sine.amplitude_rad * omega * std::cos(omega * time + sine.phase_rad);
      acceleration -= sine.amplitude_rad * omega * omega * std::sin(omega * time + sine.phase_rad);
    }
    time_s.push_back(time);
    position_rad.push_back(position);
    velocity_rad_per_s.push_back(velocity);
    torque_Nm.push_back(0.02 * acceleration + 0.05 * velocity + std::copysign(0.5, velocity));
  }
  Record record{.kind = daq::RecordKind::kMotion, .metadata = {}, .columns = {}, .source = {}};
  const std::vector<double> time = time_s;
  AddColumn(record, "time_s", std::move(time_s));
  AddColumn(record, "position_rad", std::move(position_rad));
  AddColumn(record, "velocity_rad_per_s", std::move(velocity_rad_per_s));
  AddColumn(record, "torque_Nm", std::move(torque_Nm));
  if (columns.temperature) AddTemperature(record, time);
  return record;
}

Record Vibrating() {
  constexpr double kRate_hz = 12000.0;
  constexpr double kSpeed_rpm = 2400.0;
  Record record{.kind = daq::RecordKind::kVibration, .metadata = {}, .columns = {}, .source = {}};
  record.SetMetadata("sample_rate_hz", kRate_hz);
  record.SetMetadata("input_speed_rpm", kSpeed_rpm);
  double phase_rad = 0.0;
  for (const char* name : {"accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2"}) {
    std::vector<double> values;
    for (int k = 0; k < 24000; ++k) {
      const double angle = RadPerSFromRpm(kSpeed_rpm) * k / kRate_hz;
      values.push_back(0.5 * std::cos(angle - phase_rad) + std::cos(2.0 * angle - phase_rad));
    }
    phase_rad += 1.0;
    AddColumn(record, name, std::move(values));
  }
  return record;
}

}  // namespace

std::vector<analysis::diagnosis::ParameterValue> NominalParameters(StudyKind kind) {
  if (kind == StudyKind::kTransmissionError) {
    return {{"offset_arcmin", "arcmin", 0.0, 0.0},
            {"second_harmonic_amplitude_arcmin", "arcmin", 0.5, 0.0},
            {"second_harmonic_phase_deg", "deg", 0.0, 0.0}};
  }
  if (kind == StudyKind::kHysteresis) {
    return {{"k1_Nm_per_rad", "Nm/rad", 1.6e4, 0.0},    {"k2_Nm_per_rad", "Nm/rad", 2.5e4, 0.0},
            {"k3_Nm_per_rad", "Nm/rad", 2.9e4, 0.0},    {"friction_torque_Nm", "Nm", 1.0, 0.0},
            {"yield_twist_arcmin", "arcmin", 0.3, 0.0}, {"offset_arcmin", "arcmin", 0.0, 0.0}};
  }
  if (kind == StudyKind::kMotion) {
    return {{"inertia_kgm2", "kg m^2", 0.02, 0.0},
            {"viscous_Nms_per_rad", "Nm s/rad", 0.05, 0.0},
            {"coulomb_Nm", "Nm", 0.5, 0.0},
            {"offset_Nm", "Nm", 0.0, 0.0}};
  }
  return {};
}

std::vector<analysis::diagnosis::ParameterValue> DataSheetParameters(StudyKind kind) {
  if (kind == StudyKind::kMotion) return {};
  auto parameters = NominalParameters(kind);
  std::erase_if(parameters, [](const auto& parameter) {
    return parameter.name.starts_with("offset") || parameter.name.ends_with("phase_deg");
  });
  return parameters;
}

double NominalNoise(StudyKind kind) {
  if (kind == StudyKind::kTransmissionError) return 0.03;
  if (kind == StudyKind::kHysteresis) return 0.02;
  return 0.05;
}

Record UsualExcitation(StudyKind kind, const ExcitationColumns& columns) {
  if (kind == StudyKind::kTransmissionError) return Sweep(columns);
  if (kind == StudyKind::kHysteresis) return Loops(columns);
  if (kind == StudyKind::kMotion) return MultiSine(columns);
  if (kind == StudyKind::kVibration) return Vibrating();
  throw std::invalid_argument(
      fmt::format("there is no usual measurement of kind '{}' (expected {})", NameOf(kind), kDiagnosedKinds));
}

}  // namespace strainwave::bench
