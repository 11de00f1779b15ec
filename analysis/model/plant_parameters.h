// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/model/bench_mechanics.h"
#include "analysis/model/creep.h"
#include "analysis/model/drive_causes.h"
#include "analysis/model/friction.h"
#include "analysis/model/gear_twist.h"
#include "analysis/model/kinematic_error.h"
#include "analysis/model/measuring_chain.h"
#include "analysis/model/output_drift.h"
#include "analysis/model/thermal.h"
#include "analysis/model/vibration.h"
#include "analysis/model/wear.h"

namespace strainwave::analysis::model {

/// Spread from one specimen, and one mounting of it, to the next (E25): standard deviations of the logarithm.
struct SpecimenScatter {
  double stiffness{0.04};
  double kinematic{0.08};
  double friction{0.15};
  double wear_rate{0.12};
  double wear_effect{0.10};
  double vibration{0.25};
};

/// Spread from one measurement to the next: how the teeth seat after the gear was turned and locked again
/// (docs/effects.md E25, the magnitudes are general knowledge). Standard deviations of the logarithm, drawn
/// anew for each phase.
struct SeatingScatter {
  double stiffness{0.002};
  double kinematic{0.002};
};

/// The compiled model: every term's parameters, a term that is off at the values at which it adds nothing.
struct PlantParameters {
  double ratio{80.0};
  TorsionSpring spring;
  ElastoPlasticElement hysteresis{2.33, 8e-5};  // 1 arcmin wide at zero torque
  KinematicError kinematic;
  double stiffness_ripple{0.03};  // e₂ of K(θ) = K₀(1 + e₂ cos 2θ), E7 [K]
  TwistDeviations deviations{};
  Creep creep;
  ExponentialCreepElement exponential_creep{};
  Friction friction;
  Thermal thermal;
  Ambient ambient;
  SeriesCompliance series;
  InputBrake brake;
  LoadTrain load;
  Inertia inertia;
  bool has_resonance{true};  // off: the two inertias follow at once, also in short steps
  DrivingServo servo;
  DriveCauses drive_causes;
  Encoder input_encoder{DefaultInputEncoder()};
  Encoder output_encoder{DefaultOutputEncoder()};
  OutputDrift output_drift;
  TorqueTransducer transducer;
  SlowChannelNoise noise;
  WearRates wear;
  WearEffects wear_effects;
  SpecimenScatter scatter;
  SeatingScatter seating;
  Vibration vibration;
  VibrationCauses vibration_causes;
};

/// Stiffness factor at an angle of the wave generator, from the cosine of twice that angle.
inline double StiffnessScale(double ripple, double cos2) noexcept { return 1.0 + ripple * cos2; }

/// Draws one specimen on one mounting: parameters around `nominal`, the same ones for the same seed.
PlantParameters DrawSpecimen(const PlantParameters& nominal, unsigned long long seed);

}  // namespace strainwave::analysis::model
