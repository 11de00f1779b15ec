// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/simulated/vibration_cause_synthesis.h"

#include <cmath>

#include "analysis/units.h"

namespace strainwave::bench {

namespace model = analysis::model;

VibrationCauseSynthesis::VibrationCauseSynthesis(const model::VibrationCauses& causes, double ratio,
                                                 double reference_speed_rad_per_s)
    : causes_(causes),
      ratio_(ratio),
      inverse_reference_speed_s_per_rad_(1.0 / reference_speed_rad_per_s),
      any_(causes.any()) {}

void VibrationCauseSynthesis::Start(double sample_rate_hz, std::uint64_t key) noexcept {
  noise_ = NoiseSource(NoiseKey(key, 0xdefec7));
  bearing_ = {};
  bearing_.mode.Tune(causes_.bearing.ringing.mode_Hz, causes_.bearing.ringing.mode_damping, sample_rate_hz);
  crack_ = {};
  crack_.mode.Tune(causes_.crack.ringing.mode_Hz, causes_.crack.ringing.mode_damping, sample_rate_hz);
  torsion_ = {};
  torsion_.Tune(causes_.mode.frequency_Hz, causes_.mode.damping, sample_rate_hz);
}

double VibrationCauseSynthesis::Passings::Next(const model::Ringing& ringing, double passing_rad,
                                               double modulation) noexcept {
  const double before = passed;
  passed = std::floor(passing_rad * (1.0 / kTwoPi));
  const bool passes = started && passed != before;
  started = true;
  return mode.Struck(passes ? ringing.amplitude_m_per_s2 * modulation : 0.0);
}

VibrationCauseSynthesis::Sample VibrationCauseSynthesis::Next(double input_rad,
                                                              double speed_rad_per_s) noexcept {
  const model::BearingDefect& bearing = causes_.bearing;
  const model::FlexsplineCrack& crack = causes_.crack;
  const double relative = std::abs(speed_rad_per_s) * inverse_reference_speed_s_per_rad_;
  Sample sample{};
  sample.shaft_m_per_s2 = model::Imbalance_m_per_s2(causes_.imbalance, input_rad, speed_rad_per_s) +
                          model::ModeLine_m_per_s2(causes_.mode, input_rad, speed_rad_per_s);
  sample.housing_m_per_s2 =
      relative *
      (model::BearingLine_m_per_s2(bearing, input_rad) + model::Crack_m_per_s2(crack, input_rad, ratio_) +
       bearing_.Next(bearing.ringing, bearing.order * input_rad + bearing.phase_rad,
                     model::LoadZones(bearing.modulation, input_rad)) +
       crack_.Next(crack.ringing, model::CrackOrder(ratio_) * input_rad + crack.phase_rad,
                   model::CrackSide(crack.modulation, input_rad, ratio_)) +
       causes_.mode.deviation_m_per_s2 * torsion_.Driven(noise_()));
  return sample;
}

}  // namespace strainwave::bench
