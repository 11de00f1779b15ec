// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>

#include "analysis/model/plant_parameters.h"
#include "analysis/units.h"

namespace strainwave::analysis::model {
namespace {

// Boost's distributions give the same numbers with every standard library, std's do not.
class Draw {
 public:
  explicit Draw(unsigned long long seed) : engine_(seed) {}

  double Normal() { return normal_(engine_); }
  double Factor(double sd) { return std::exp(sd * Normal()); }
  double Phase_rad() { return uniform_(engine_); }

 private:
  std::mt19937_64 engine_;
  boost::random::normal_distribution<double> normal_;
  boost::random::uniform_real_distribution<double> uniform_{0.0, kTwoPi};
};

}  // namespace

PlantParameters DrawSpecimen(const PlantParameters& nominal, unsigned long long seed) {
  PlantParameters drawn = nominal;
  Draw draw(seed);
  const SpecimenScatter& sd = nominal.scatter;

  // The gear as a whole is stiffer or softer; the segments differ by less among themselves.
  const double stiffer = draw.Factor(sd.stiffness);
  for (double* k : {&drawn.spring.k1_Nm_per_rad, &drawn.spring.k2_Nm_per_rad, &drawn.spring.k3_Nm_per_rad}) {
    const double factor = stiffer * draw.Factor(0.3 * sd.stiffness);
    if (*k < kRigid_Nm_per_rad) *k *= factor;
  }
  drawn.hysteresis.limit_Nm *= draw.Factor(sd.kinematic);
  for (std::size_t k = 0; k < kKinematicOrders; ++k) {
    drawn.kinematic.amplitude_rad[k] *= draw.Factor(sd.kinematic);
    if (sd.kinematic > 0.0) drawn.kinematic.phase_rad[k] = draw.Phase_rad();
  }
  const double tighter = draw.Factor(sd.friction);
  for (double* part : {&drawn.friction.coulomb_Nm, &drawn.friction.breakaway_Nm,
                       &drawn.friction.viscous_at_0_degC_Nms_per_rad, &drawn.friction.load_coefficient,
                       &drawn.friction.flexspline_Nm, &drawn.friction.flexspline_load_coefficient}) {
    *part *= tighter;
  }
  for (double* rate : {&drawn.wear.tooth_steady, &drawn.wear.tooth_running_in, &drawn.wear.flexspline_start,
                       &drawn.wear.grease_rate}) {
    *rate *= draw.Factor(sd.wear_rate);
  }
  WearEffects& effects = drawn.wear_effects;
  for (double* effect : {&effects.tooth_k1, &effects.flexspline_k2, &effects.flexspline_k3,
                         &effects.tooth_hysteresis, &effects.tooth_kinematic, &effects.flexspline_kinematic,
                         &effects.tooth_friction, &effects.grease_friction}) {
    *effect *= draw.Factor(sd.wear_effect);
  }
  for (std::size_t c = 0; c < kVibrationChannels; ++c) {
    for (std::size_t k = 0; k < kVibrationOrders; ++k) {
      drawn.vibration.order_gain[c][k] *= draw.Factor(sd.vibration);
      if (sd.vibration > 0.0) drawn.vibration.order_phase_rad[c][k] = draw.Phase_rad();
    }
    for (double& gain : drawn.vibration.mode_gain[c]) gain *= draw.Factor(sd.vibration);
  }
  drawn.transducer.gain_error += nominal.transducer.gain_error_sd * draw.Normal();
  return drawn;
}

}  // namespace strainwave::analysis::model
