// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "analysis/model/vibration_causes.h"
#include "bench/devices/simulated/noise_source.h"
#include "bench/devices/simulated/resonator.h"

namespace strainwave::bench {

/// Sample by sample, what defects add to the vibration of a healthy drive
/// (analysis/model/vibration_causes.h). Has noise of its own, so that a defect does not shift that of the
/// rest.
class VibrationCauseSynthesis {
 public:
  VibrationCauseSynthesis(const analysis::model::VibrationCauses& causes, double ratio,
                          double reference_speed_rad_per_s);

  bool any() const noexcept { return any_; }
  void Start(double sample_rate_hz, std::uint64_t key) noexcept;

  /// Acceleration that reaches a sensor the way the shaft's lines do, and the way the housing's ringing does.
  struct Sample {
    double shaft_m_per_s2;
    double housing_m_per_s2;
  };
  /// The next sample, at an input angle and speed.
  Sample Next(double input_rad, double speed_rad_per_s) noexcept;

 private:
  // A mode that gets an impulse at each passing.
  struct Passings {
    Resonator mode;
    bool started{};
    double passed{};  // so far, counted from the angle zero

    double Next(const analysis::model::Ringing& ringing, double passing_rad, double modulation) noexcept;
  };
  analysis::model::VibrationCauses causes_;
  double ratio_;
  double inverse_reference_speed_s_per_rad_;
  bool any_;
  NoiseSource noise_;
  Passings bearing_;
  Passings crack_;
  Resonator torsion_;
};

}  // namespace strainwave::bench
