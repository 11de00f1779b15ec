// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <complex>

#include "analysis/model/vibration_orders.h"
#include "analysis/units.h"

namespace strainwave::analysis::model {

/// A mode excited by impacts: responses e^(−ζωt) sin ωt, one each time that something passes.
struct Ringing {
  double amplitude_m_per_s2{};  // of an impact's response, before the modulation
  double mode_Hz{3600.0};
  double mode_damping{0.03};
};

/// A race or a ball of the wave generator's bearing (E24): a line at the passing order, modulated twice a
/// turn by the two load zones of the ellipse, and a mode that rings at each passing. Orders: outer race
/// (n/2)(1 − d/D), inner race (n/2)(1 + d/D), per input turn.
struct BearingDefect {
  double amplitude_m_per_s2{};  // of the line
  double order{10.35};          // 23 balls, d/D = 0.1, outer race [K]
  double phase_rad{};           // of A sin(order · θ + phase)
  double modulation{0.5};       // at two per input turn
  Ringing ringing;
};

/// Mass off the axis of the input shaft: one per turn, rising with the speed squared.
struct Imbalance {
  double amplitude_m_per_s2{};  // at `reference_speed_rad_per_s`
  double phase_rad{};           // of A sin(θ + phase)
  double reference_speed_rad_per_s{RadPerSFromRpm(1000.0)};
};

/// A crack in the flexspline meets a lobe of the wave generator 2(1 + 1/N) times an input turn, since the
/// flexspline turns back by 1/N meanwhile; modulated as the cracked place goes round, once an output turn.
struct FlexsplineCrack {
  double amplitude_m_per_s2{};  // of the line at the passing order
  double phase_rad{};
  double harmonic_share{0.5};  // of each harmonic to the one before it
  double modulation{0.4};      // at one per output turn
  Ringing ringing;
};
inline constexpr int kCrackHarmonics = 3;

/// A torsional mode of the train: friction noise rings it in a narrow band, and a line of the shaft that
/// comes near it grows (docs/effects.md E15).
struct TorsionalMode {
  double deviation_m_per_s2{};  // standard deviation of the narrow band
  double line_m_per_s2{};       // amplitude of the line before the mode acts on it
  double line_order{2.0};
  double frequency_Hz{60.0};
  double damping{0.02};
};

/// What a drive may vibrate with beyond a healthy one. Amplitudes are those at the reference speed of the
/// vibration model, in proportion to speed, but for the imbalance and the mode's line.
struct VibrationCauses {
  BearingDefect bearing;
  Imbalance imbalance;
  FlexsplineCrack crack;
  TorsionalMode mode;

  bool any() const noexcept {
    return bearing.amplitude_m_per_s2 != 0.0 || bearing.ringing.amplitude_m_per_s2 != 0.0 ||
           imbalance.amplitude_m_per_s2 != 0.0 || crack.amplitude_m_per_s2 != 0.0 ||
           crack.ringing.amplitude_m_per_s2 != 0.0 || mode.deviation_m_per_s2 != 0.0 ||
           mode.line_m_per_s2 != 0.0;
  }
};

/// Share of the two load zones at an input angle: 1 + m cos 2θ.
inline double LoadZones(double modulation, double input_rad) noexcept {
  return 1.0 + modulation * std::cos(2.0 * input_rad);
}

inline double BearingLine_m_per_s2(const BearingDefect& bearing, double input_rad) noexcept {
  return bearing.amplitude_m_per_s2 * LoadZones(bearing.modulation, input_rad) *
         std::sin(bearing.order * input_rad + bearing.phase_rad);
}

inline double Imbalance_m_per_s2(const Imbalance& imbalance, double input_rad,
                                 double speed_rad_per_s) noexcept {
  return imbalance.amplitude_m_per_s2 *
         ImbalanceGrowth(speed_rad_per_s, imbalance.reference_speed_rad_per_s) *
         std::sin(input_rad + imbalance.phase_rad);
}

inline double ModeLine_m_per_s2(const TorsionalMode& mode, double input_rad,
                                double speed_rad_per_s) noexcept {
  const std::complex<double> gain =
      ResonantGain(mode.line_order * speed_rad_per_s, kTwoPi * mode.frequency_Hz, mode.damping);
  const double angle_rad = mode.line_order * input_rad;
  return mode.line_m_per_s2 * (gain.real() * std::cos(angle_rad) - gain.imag() * std::sin(angle_rad));
}

/// Sizes of a crack's passings: 1 + m cos(output angle).
inline double CrackSide(double modulation, double input_rad, double ratio) noexcept {
  return 1.0 + modulation * std::cos(input_rad / ratio);
}

inline double Crack_m_per_s2(const FlexsplineCrack& crack, double input_rad, double ratio) noexcept {
  const double passing_rad = CrackOrder(ratio) * input_rad + crack.phase_rad;
  double amplitude = crack.amplitude_m_per_s2 * CrackSide(crack.modulation, input_rad, ratio);
  double sum = 0.0;
  for (int harmonic = 1; harmonic <= kCrackHarmonics; ++harmonic) {
    sum += amplitude * std::sin(harmonic * passing_rad);
    amplitude *= crack.harmonic_share;
  }
  return sum;
}

/// Mean square of the ringing at so many impacts a second: a decaying response of size r holds r²/(4ζω).
inline double RingingSquare(const Ringing& ringing, double impacts_per_s) noexcept {
  return ringing.amplitude_m_per_s2 * ringing.amplitude_m_per_s2 * impacts_per_s /
         (4.0 * ringing.mode_damping * kTwoPi * ringing.mode_Hz);
}

/// Mean squares that add to a channel's level at a speed: what rises with the fourth power of the speed, and
/// what rises with its square. Without the line of the torsional mode.
struct CauseSquares {
  double fourth{};
  double second{};
};
inline CauseSquares SquaresAt(const VibrationCauses& causes, double speed_rad_per_s, double ratio) noexcept {
  const Imbalance& imbalance = causes.imbalance;
  const double shaft =
      imbalance.amplitude_m_per_s2 * ImbalanceGrowth(speed_rad_per_s, imbalance.reference_speed_rad_per_s);
  const double turns_per_s = speed_rad_per_s / kTwoPi;
  const BearingDefect& bearing = causes.bearing;
  const double zones = 1.0 + 0.5 * bearing.modulation * bearing.modulation;
  double second = zones * (0.5 * bearing.amplitude_m_per_s2 * bearing.amplitude_m_per_s2 +
                           RingingSquare(bearing.ringing, bearing.order * turns_per_s));
  const FlexsplineCrack& crack = causes.crack;
  double lines = RingingSquare(crack.ringing, CrackOrder(ratio) * turns_per_s);
  double harmonic = crack.amplitude_m_per_s2;
  for (int k = 0; k < kCrackHarmonics; ++k) {
    lines += 0.5 * harmonic * harmonic;
    harmonic *= crack.harmonic_share;
  }
  second += lines * (1.0 + 0.5 * crack.modulation * crack.modulation);
  second += causes.mode.deviation_m_per_s2 * causes.mode.deviation_m_per_s2;
  return {0.5 * shaft * shaft, second};
}

}  // namespace strainwave::analysis::model
