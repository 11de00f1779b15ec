// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "analysis/units.h"

namespace strainwave::analysis::model {

/// What turns and what bends on the bench around the gear: docs/effects.md E15 to E21.

/// Couplings and transducer in series with the gear, between it and the output encoder (E17 [D]).
struct SeriesCompliance {
  double transducer_rad_per_Nm{1.0 / 4.0e4};
  double couplings_rad_per_Nm{1.0 / 3.0e4};

  double total_rad_per_Nm() const noexcept { return transducer_rad_per_Nm + couplings_rad_per_Nm; }
};

/// Other ways in which a brake may give way beyond what it holds, beside a speed that grows with the excess.
/// At the motor shaft; all of them zero in a nominal brake.
struct BrakeYield {
  double speed_rad_per_s{};          // one speed, whatever the excess
  double each_time_rad_per_Nm{};     // with every rise of the excess
  double only_further_rad_per_Nm{};  // with the excess beyond any since the brake closed
  double once_rad{};                 // all at once, the first time since the brake closed

  bool any() const noexcept {
    return speed_rad_per_s != 0.0 || each_time_rad_per_Nm != 0.0 || only_further_rad_per_Nm != 0.0 ||
           once_rad != 0.0;
  }
};
/// How far the brake gives way in a step.
/// @param excess_Nm, before_Nm  ≥ 0, beyond the holding torque, now and at the step before.
/// @param furthest_Nm           largest excess since the brake closed, up to the step before.
inline double BrakeYield_rad(const BrakeYield& yield, double excess_Nm, double before_Nm, double furthest_Nm,
                             double step_s) noexcept {
  if (!(excess_Nm > 0.0)) return 0.0;
  return yield.speed_rad_per_s * step_s + yield.each_time_rad_per_Nm * std::max(0.0, excess_Nm - before_Nm) +
         yield.only_further_rad_per_Nm * std::max(0.0, excess_Nm - furthest_Nm) +
         (furthest_Nm > 0.0 ? 0.0 : yield.once_rad);
}

/// Holding brake on the motor shaft: elastic up to what it holds, then it slips (E17).
struct InputBrake {
  double compliance_rad_per_Nm{1.0 / 1.5e4};
  double holding_torque_Nm{2.39};
  double slip_damping_Nms_per_rad{0.2};
  BrakeYield yield{};
};

/// Load servo with its 1:70 planetary, seen at the output.
struct LoadTrain {
  double drag_Nm{0.5};               // what the load drive's friction compensation leaves
  double drag_presliding_rad{7e-4};  // presliding of the load motor, divided by 70
  double drag_viscous_Nms_per_rad{0.05};
  double brake_holding_Nm{167.0};
  double brake_stiffness_Nm_per_rad{5.0e4};
  double torque_lag_s{0.004};  // bandwidth of the torque loop, E21
  double cogging_Nm{0.006};    // one per turn of the load motor, E21
  double ripple_share{0.003};  // of the commanded torque, same order
  double unbalance_Nm{0.004};  // one per output turn, E21
  double motor_turns_per_output_turn{70.0};
};

/// Inertias of the two-mass system (E15). Motor with wave generator [K]; at the output couplings, transducer
/// and planetary, with what the load servo's acceleration feed-forward leaves of its rotor (E15: 0.05 to
/// 0.5).
struct Inertia {
  double input_kgm2{7.0e-5};
  double output_kgm2{0.1};
  double damping_Nms_per_rad{1.5};  // of the twist
};

/// Driving servo, 750 W.
struct DrivingServo {
  double rated_torque_Nm{2.39};
  double peak_torque_Nm{7.16};
  double top_speed_rad_per_s{RadPerSFromRpm(6000.0)};
  double speed_bandwidth_rad_per_s{kTwoPi * 30.0};
  double position_gain_per_s{60.0};
  double cogging_Nm{0.024};                  // eight per turn; 1 % of rated torque, E16 [K]
  double kt_per_K{-0.001};                   // change of the torque constant, E16 [K]
  double current_offset_Nm{0.004};           // E16
  double coupling_misalignment_rad{0.0087};  // half a degree, E19
};

/// Angle error of a coupling misaligned by b at shaft angle θ: (b²/4)·sin 2θ (E19).
inline double CouplingErrorAmplitude_rad(double misalignment_rad) noexcept {
  return 0.25 * misalignment_rad * misalignment_rad;
}

/// Torsional resonance of input and output inertia about the gear: (1/2π)·√(K·(1/J_L + 1/(N²·J_m))) (E15).
inline double TorsionalResonance_Hz(double stiffness_Nm_per_rad, const Inertia& inertia,
                                    double ratio) noexcept {
  return std::sqrt(stiffness_Nm_per_rad *
                   (1.0 / inertia.output_kgm2 + 1.0 / (ratio * ratio * inertia.input_kgm2))) /
         kTwoPi;
}

}  // namespace strainwave::analysis::model
