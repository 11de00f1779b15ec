// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "analysis/model/plant_parameters.h"
#include "bench/devices/simulated/delay_line.h"
#include "bench/devices/simulated/plant_state.h"

namespace strainwave::bench {

/// What the drives ask of the mechanics during one step.
struct PlantCommands {
  enum class Input { kFree, kTorque, kSpeed, kPosition };
  Input input{Input::kFree};
  double input_set_point{};  // Nm, rad/s or rad, by `input`
  bool input_brake{true};
  bool load_enabled{};
  double load_torque_Nm{};                     // at the output
  std::optional<double> load_speed_rad_per_s;  // of the output; the load servo then finds the torque itself
  bool load_brake{true};
};

/// The mechanics of the bench: servo, gear, couplings, transducer and load train, stepped in time.
///
/// Steps of at most `kLongestDynamicStep_s` are integrated: two inertias, the gear's spring with damping
/// between them, the servo's speed loop, in substeps of at most a quarter of a millisecond. Longer steps take
/// the quasi-static limit: the servo follows its set point, the output is where the torques balance, inertia
/// counts only through the acceleration of the set point. The two agree for motion that is slow beside the
/// torsional resonance (some 50 Hz); torque ripple at two per input turn (docs/effects.md E14, E15) is in the
/// short steps alone, as is the delay of the drive. An input that nothing holds is integrated at any step.
///
/// Effects that a nominal gear does not have (`TwistDeviations`, `DriveCauses`, ...) cost nothing while they
/// are off. In short steps the rate dependence of the gear is limited to what the integration carries.
///
/// Temperatures, wear and what depends on them move on once a second.
class GearPlant {
 public:
  static constexpr double kLongestDynamicStep_s = 2.0e-3;

  explicit GearPlant(const analysis::model::PlantParameters& specimen);

  void Step(const PlantCommands& commands, double step_s) noexcept;

  const PlantState& state() const noexcept { return state_; }
  /// Takes over a state; what depends on the slow states follows it. A measurement begins: time counts from
  /// here for what drifts or acts in windows of time, and no torque is on its way.
  void SetState(const PlantState& state) noexcept;
  /// Puts a rigid shaft in the gear's place (ratio 1, only the series compliance), or the gear back.
  void MountBlank(bool mounted) noexcept;
  void SetGearTemperature(double temperature_degC) noexcept;
  /// How the teeth have seated this time, as factors on stiffness and kinematic error.
  struct Seating {
    double stiffness{1.0};
    double kinematic{1.0};
  };
  void SetSeating(const Seating& seating) noexcept { seating_ = seating; }

  const analysis::model::PlantParameters& specimen() const noexcept { return specimen_; }
  /// The properties of the gear as it is now, worn and at its temperature.
  const analysis::model::TwistLaw& law() const noexcept { return law_; }
  const analysis::model::KinematicSeries& kinematic() const noexcept { return kinematic_; }
  const analysis::model::FrictionAtTemperature& friction() const noexcept { return friction_; }
  double ratio() const noexcept { return ratio_; }
  double room_degC() const noexcept { return room_degC_; }
  /// Since the last state was taken over.
  double measurement_time_s() const noexcept { return state_.time_s - measurement_start_s_; }
  /// Sine of four times the input angle: one period for each pole pair of the motor.
  double electrical_sine() const noexcept { return electrical_sine_; }

 private:
  // Step-length dependent factors, kept because the step length hardly ever changes.
  struct StepFactors {
    double step_s{-1.0};
    analysis::model::CreepStep creep;
    double load_lag{};
    double position{};
  };
  // What depends on the input angle alone.
  struct AtAngle {
    double error_rad, error_derivative, stiffness_scale, cos1, cos2, cos8, output_sin;
  };

  void PrepareFactors(StepFactors& factors, double step_s) const noexcept;
  template <bool kExtended>
  AtAngle Evaluate(double input_rad) noexcept;
  template <bool kExtended>
  void StepPieces(const PlantCommands& commands, double step_s) noexcept;
  void StepBrakes(const PlantCommands& commands, double step_s) noexcept;
  void CloseLoadBrake(bool closed) noexcept;
  template <bool kExtended>
  void StepQuasiStatic(const PlantCommands& commands, double step_s) noexcept;
  template <bool kExtended>
  void StepDynamic(const PlantCommands& commands, double step_s) noexcept;
  template <bool kExtended>
  void Substep(const PlantCommands& commands, double step_s) noexcept;
  double ReflectedInertia() const noexcept;
  double ReachableSpeed(double wanted_rad_per_s, double step_s) const noexcept;
  double ApproachSpeed(double remaining_rad, double wanted_rad_per_s) const noexcept;
  double ServoTorque(const PlantCommands& commands, double step_s) noexcept;
  double AskedOfLoad(const PlantCommands& commands, double step_s) noexcept;
  // What a nominal gear does not have (gear_plant_causes.cc). Steps come in two: the extended one looks which
  // of these effects are on, the other knows that none is.
  analysis::model::TwistSolution Balance(const analysis::model::TwistCurve& curve, double scale,
                                         const analysis::model::OutputGrip& grip, double no_load_rad,
                                         double load_Nm, double step_s) noexcept;
  analysis::model::TwistSolution AtDeflection(const analysis::model::TwistCurve& curve, double scale,
                                              double deflection_rad) noexcept;
  void MoveFurtherAnchors() noexcept;
  double YieldOfBrake(double excess_Nm, double step_s) noexcept;
  void AdvanceExponentialCreep(double step_s) noexcept;
  double ShortStepDamping() const noexcept;
  double ExtraDrag_Nm(double speed_rad_per_s) const noexcept;
  double ExtraLoad_Nm(double input_rad) const noexcept;
  double DisturbedLoad(const PlantCommands& commands, double output_sin) const noexcept;
  double InputFriction(double dry_Nm, double speed_rad_per_s) noexcept;
  double SlipBrake(double step_s) noexcept;
  void Account(double travel_rad, double friction_Nm, double step_s) noexcept;
  void UpdateSlowStates() noexcept;
  void RefreshProperties() noexcept;
  analysis::model::OutputGrip Grip() const noexcept;
  bool dynamics_possible() const noexcept;

  analysis::model::PlantParameters specimen_;
  double ratio_;
  double inverse_ratio_;
  double room_degC_{};
  analysis::model::TwistLaw law_;
  analysis::model::TwistCurve free_curve_;
  analysis::model::TwistCurve locked_curve_;  // with the brake's compliance on top
  analysis::model::KinematicSeries kinematic_;
  analysis::model::FrictionAtTemperature friction_;
  double stiffness_ripple_{};
  bool extended_{};  // any effect that a nominal gear does not have
  bool has_drive_causes_{};
  bool has_exponential_creep_{};
  bool has_brake_yield_{};
  double damping_Nms_per_rad_{};  // of the twist in short steps
  double measurement_start_s_{};
  Seating seating_;
  double electrical_sine_{};
  double load_integral_Nm_{};  // of the load servo's speed loop; gone with its power
  StepFactors quasi_static_;
  StepFactors substep_;
  PlantState state_;
  DelayLine delay_;
};

}  // namespace strainwave::bench
