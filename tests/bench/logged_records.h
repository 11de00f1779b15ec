// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "analysis/units.h"
#include "bench/errors/bench_error.h"
#include "bench/records/look_at_samples.h"
#include "daq/record.h"

/// Healthy records of each kind, and what loggers do to them.
namespace strainwave::bench::logged_records {

using daq::Direction;
using daq::Record;
using Notes = std::vector<daq::RecordNote>;

inline constexpr int kFirstLine = 4;

inline void AddColumn(Record& record, const std::string& name, std::vector<double> values) {
  record.columns.push_back({name, std::move(values), "", ""});
}

inline Record New(const std::string& kind) {
  Record record;
  record.kind = daq::RecordKind::Named(kind);
  record.source = {"r.csv", kFirstLine, ""};
  return record;
}

inline double Noise(std::mt19937& random, double deviation) {
  return std::normal_distribution(0.0, deviation)(random);
}

// A turn forth and back in steps; 1.2' of range, 0.3' of lost motion.
inline Record Sweep(double step_deg = 1.0, double ratio = 80.0) {
  std::mt19937 random(5);
  Record record = New("transmission_error");
  std::vector<Direction> direction;
  std::vector<double> input_deg;
  std::vector<double> output_deg;
  const int steps = static_cast<int>(std::lround(360.0 / step_deg));
  for (const int way : {1, -1}) {
    for (int i = 0; i <= steps; ++i) {
      const double at_deg = step_deg * (way > 0 ? i : steps - i);
      const double error_arcmin = 0.6 * std::cos(RadFromDeg(at_deg)) - 0.15 * way + Noise(random, 0.004);
      direction.push_back(way > 0 ? Direction::kClockwise : Direction::kCounterClockwise);
      input_deg.push_back(ratio * at_deg);
      output_deg.push_back(at_deg - error_arcmin / 60.0);
    }
  }
  record.SetMetadata("ratio", ratio);
  record.columns.push_back({"direction", direction, "", ""});
  AddColumn(record, "input_angle_deg", input_deg);
  AddColumn(record, "output_angle_deg", output_deg);
  return record;
}

// Of an axis that is led along sines, with friction: 100 samples a second.
inline Record Axis(double rate_hz = 100.0, double position_noise_rad = 2e-5, double torque_noise_Nm = 0.04) {
  std::mt19937 random(6);
  Record record = New("motion");
  std::vector<double> time_s;
  std::vector<double> position_rad;
  std::vector<double> torque_Nm;
  for (int i = 0; i < 8.0 * rate_hz; ++i) {
    const double t = i / rate_hz;
    const double speed = 2.4 * std::cos(1.7 * t) + 1.8 * std::cos(4.1 * t + 1.0);
    const double acceleration = -2.4 * 1.7 * std::sin(1.7 * t) - 1.8 * 4.1 * std::sin(4.1 * t + 1.0);
    time_s.push_back(t);
    position_rad.push_back(2.4 / 1.7 * std::sin(1.7 * t) + 1.8 / 4.1 * std::sin(4.1 * t + 1.0) +
                           Noise(random, position_noise_rad));
    torque_Nm.push_back(1e-3 *
                        std::round(1e3 * (0.08 * acceleration + 0.2 * speed + std::copysign(0.9, speed) +
                                          Noise(random, torque_noise_Nm))));
  }
  AddColumn(record, "time_s", time_s);
  AddColumn(record, "position_rad", position_rad);
  AddColumn(record, "torque_Nm", torque_Nm);
  return record;
}

// The same with its velocity, of a resolution; what is beyond `end` reads `end`.
inline Record AxisWithVelocity(double end_rad_per_s, double step_rad_per_s) {
  std::mt19937 random(8);
  Record record = Axis();
  std::vector<double> velocity;
  for (int i = 0; i < 800; ++i) {
    const double t = i / 100.0;
    const double speed = 2.4 * std::cos(1.7 * t) + 1.8 * std::cos(4.1 * t + 1.0) + Noise(random, 0.01);
    velocity.push_back(step_rad_per_s *
                       std::round(std::clamp(speed, -end_rad_per_s, end_rad_per_s) / step_rad_per_s));
  }
  AddColumn(record, "velocity_rad_per_s", velocity);
  return record;
}

inline Record Vibration(double rate_hz = 12800.0) {
  std::mt19937 random(7);
  Record record = New("vibration");
  std::vector<double> time_s;
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 4096; ++i) {
    time_s.push_back(i / rate_hz);
    x.push_back(std::sin(kTwoPi * 50.0 * i / rate_hz) + Noise(random, 0.2));
    y.push_back(std::sin(kTwoPi * 100.0 * i / rate_hz) + Noise(random, 0.2));
  }
  AddColumn(record, "time_s", time_s);
  AddColumn(record, "accel_x_m_per_s2", x);
  AddColumn(record, "accel_y_m_per_s2", y);
  return record;
}

inline void Change(Record& record, const std::string& column,
                   const std::function<double(double, std::size_t)>& change) {
  for (daq::Column& one : record.columns) {
    if (one.name != column) continue;
    auto& values = std::get<std::vector<double>>(one.values);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = change(values[i], i);
  }
}

inline void Wrap(Record& record, const std::string& column, double modulus, double low) {
  Change(record, column,
         [&](double value, std::size_t) { return value - modulus * std::floor((value - low) / modulus); });
}

inline void Hold(Record& record, const std::string& column, const std::function<bool(std::size_t)>& comes) {
  double last = 0.0;
  Change(record, column,
         [&](double value, std::size_t i) { return last = i == 0 || comes(i) ? value : last; });
}

inline std::vector<std::string> Looked(Record& record) {
  LookAtSamples(record);
  std::vector<std::string> texts;
  for (const daq::RecordNote& note : record.notes) texts.push_back(note.text);
  return texts;
}

inline std::string Refusal(Record record) {
  try {
    LookAtSamples(record);
  } catch (const BenchError& error) {
    return error.what();
  }
  return "taken";
}

}  // namespace strainwave::bench::logged_records
