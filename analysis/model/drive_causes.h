// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace strainwave::analysis::model {

/// Torque from outside in a window of time, counted from the start of the measurement.
struct TorqueWindow {
  double torque_Nm{};
  double start_s{};
  double end_s{};
  double edge_share{};  // of the window, that its rise and its fall take each: 0 a rectangle, 0.5 a bell
};

/// A torque that follows the angle of the shaft: amplitude · sin(order · θ + phase).
struct PeriodicTorque {
  double amplitude_Nm{};
  double order{1.0};  // per turn of the shaft, any number
  double phase_rad{};
};

/// What may resist a driving shaft beyond inertia and the friction law. All of them count as the drive feels
/// them: positive takes torque from a drive that turns forwards.
struct DriveCauses {
  double viscous_difference_Nms_per_rad{};  // forwards minus backwards
  double quadratic_Nms2_per_rad2{};
  PeriodicTorque periodic{0.0, 6.0, 0.0};  // ripple, cogging of any order
  PeriodicTorque unbalance;                // weight off the axis, one per turn
  double constant_Nm{};
  std::array<TorqueWindow, 3> disturbance;
  double delay_s{};  // torque acts this much after the drive has reported it

  bool any_torque() const noexcept {
    bool windows = false;
    for (const TorqueWindow& window : disturbance) windows = windows || window.torque_Nm != 0.0;
    return windows || viscous_difference_Nms_per_rad != 0.0 || quadratic_Nms2_per_rad2 != 0.0 ||
           periodic.amplitude_Nm != 0.0 || unbalance.amplitude_Nm != 0.0 || constant_Nm != 0.0;
  }
};
/// Longest delay that the simulated bench carries.
inline constexpr double kLongestDriveDelay_s = 0.016;

/// Viscous friction that differs by direction, as what comes on top of the mean of both: ½·difference·|ω|.
inline double AsymmetricViscous_Nm(double difference_Nms_per_rad, double speed_rad_per_s) noexcept {
  return 0.5 * difference_Nms_per_rad * std::abs(speed_rad_per_s);
}

/// Drag that rises with the speed squared, against the motion: c·ω·|ω|.
inline double QuadraticDrag_Nm(double drag_Nms2_per_rad2, double speed_rad_per_s) noexcept {
  return drag_Nms2_per_rad2 * speed_rad_per_s * std::abs(speed_rad_per_s);
}

inline double PeriodicTorque_Nm(const PeriodicTorque& torque, double angle_rad) noexcept {
  return torque.amplitude_Nm * std::sin(torque.order * angle_rad + torque.phase_rad);
}

/// 0 outside a window of time, 1 inside, with a smooth rise (3u² − 2u³) and fall of `edge_s` each. The end is
/// outside.
inline double WindowShape(double time_s, double start_s, double end_s, double edge_s) noexcept {
  if (time_s < start_s || time_s >= end_s) return 0.0;
  const double u = edge_s > 0.0 ? std::min({time_s - start_s, end_s - time_s, edge_s}) / edge_s : 1.0;
  return u * u * (3.0 - 2.0 * u);
}

inline double WindowTorque_Nm(const TorqueWindow& window, double time_s) noexcept {
  return window.torque_Nm * WindowShape(time_s, window.start_s, window.end_s,
                                        window.edge_share * (window.end_s - window.start_s));
}

}  // namespace strainwave::analysis::model
