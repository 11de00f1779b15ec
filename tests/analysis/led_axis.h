// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {

/// A path to and fro, of sines.
struct Sine {
  double size_rad, rad_per_s, phase_rad{0.0};
};
using SinePath = std::vector<Sine>;

struct PathState {
  double position_rad{}, speed_rad_per_s{}, acceleration_rad_per_s2{};
};

inline PathState StateOn(const SinePath& path, double time_s) {
  PathState state;
  for (const auto& [size_rad, rad_per_s, phase_rad] : path) {
    const double angle = rad_per_s * time_s + phase_rad;
    state.position_rad += size_rad * std::sin(angle);
    state.speed_rad_per_s += size_rad * rad_per_s * std::cos(angle);
    state.acceleration_rad_per_s2 -= size_rad * rad_per_s * rad_per_s * std::sin(angle);
  }
  return state;
}

/// An axis that is led along its path whatever torque that takes, with a load behind a gap: a stiff, damped
/// contact at either end, which pushes and never pulls, and dry friction of the load's own.
struct LedAxis {
  SinePath path;
  double duration_s{};
  double step_s{};  // of the integration
  int each{};       // step that is a sample
  double inertia_kgm2{}, viscous_Nms_per_rad{}, coulomb_Nm{};
  double load_kgm2{}, half_gap_rad{}, load_friction_per_s2{}, contact_rad_per_s{}, contact_damping{};
  double load_start{1.0};  // place in the gap: 1 where the motion pushes the load, −1 at the other end
  double torque_noise_Nm{}, position_noise_rad{};
};

inline MotionData RecordOf(const LedAxis& axis, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MotionData record;
  const PathState start = StateOn(axis.path, 0.0);
  double load = start.position_rad - axis.load_start * axis.half_gap_rad;
  double load_speed = start.speed_rad_per_s;
  for (int i = 0; i * axis.step_s < axis.duration_s; ++i) {
    const double time_s = i * axis.step_s;
    const PathState at = StateOn(axis.path, time_s);
    const double lead = at.position_rad - load;
    const double sense = std::copysign(1.0, lead);
    const double into = std::abs(lead) - axis.half_gap_rad;
    const double drag =
        2.0 * axis.contact_damping * axis.contact_rad_per_s * (at.speed_rad_per_s - load_speed);
    const double push =
        into > 0.0
            ? sense * std::max(0.0, axis.contact_rad_per_s * axis.contact_rad_per_s * into + sense * drag)
            : 0.0;
    if (i % axis.each == 0) {
      record.time_s.push_back(time_s);
      record.position.push_back(at.position_rad);
      if (axis.position_noise_rad > 0.0) record.position.back() += axis.position_noise_rad * normal(random);
      record.torque.push_back(axis.inertia_kgm2 * at.acceleration_rad_per_s2 +
                              axis.viscous_Nms_per_rad * at.speed_rad_per_s +
                              std::copysign(axis.coulomb_Nm, at.speed_rad_per_s) + axis.load_kgm2 * push +
                              axis.torque_noise_Nm * normal(random));
    }
    const double free = load_speed + axis.step_s * push;
    const double held = axis.step_s * axis.load_friction_per_s2;
    load_speed = free - std::clamp(free, -held, held);
    load += axis.step_s * load_speed;
  }
  return record;
}

}  // namespace strainwave::analysis::diagnosis
