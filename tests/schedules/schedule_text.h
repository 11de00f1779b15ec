// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "schedules/reader/read_schedule.h"

namespace strainwave::schedules {

/// A small schedule without mistakes; tests put one in. Line 1 is `schedule: 1`.
inline std::string GoodSchedule() {
  return R"(schedule: 1
name: small
specimen:
  identity: SN-1
  model: size 20
  ratio: 80
  t1: 7 Nm
  t2: 25 Nm
  t3: 34 Nm
  rated_torque: 34 Nm
  rated_speed: 2000 rpm
  bearing_l10: 7000 h
  ratcheting_torque: 350 Nm
  buckling_torque: 330 Nm
  flexspline_teeth: 160
  circular_spline_teeth: 162
limits:
  output_torque: 60 Nm
  input_speed: 3000 rpm
  gear_temperature: 75 degC
  vibration_rms: 50 m/s2
  twist: 30 arcmin
cycles: 3
phases:
  - kind: load_run
    duration: 30 min
    output_torque: 40 Nm
    input_speed: 2400 rpm
  - kind: hysteresis
    peak_torque: 34 Nm
  - kind: transmission_error
    input_speed: 300 rpm
measurements:
  declared_temperature: 45 degC
)";
}

/// `text` with the one place that reads `from` changed to `to`.
inline std::string With(std::string text, std::string_view from, std::string_view to) {
  const std::size_t place = text.find(from);
  if (place == std::string::npos) throw std::logic_error("not in the text: " + std::string(from));
  return text.replace(place, from.size(), to);
}

/// What the reader says of a text called small.yaml; empty if it takes it.
inline std::string MessageOf(const std::string& text) {
  try {
    ParseSchedule(text, "small.yaml");
    return {};
  } catch (const ScheduleError& error) {
    return error.what();
  }
}

}  // namespace strainwave::schedules
