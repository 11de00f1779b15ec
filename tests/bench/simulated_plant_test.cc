// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/devices/simulated/turn_table.h"
#include "tests/bench/causes_helpers.h"

namespace strainwave::bench::simulated_plant_test {
namespace {

model::PlantParameters Nominal(std::initializer_list<std::string_view> without = {}) {
  return model::CompilePlantModel(ModelWithout(without));
}

PlantCommands AtSpeed(double speed_rad_per_s, double load_Nm) {
  return Driven(Input::kSpeed, speed_rad_per_s, load_Nm);
}

// Loads that only spoil a comparison with a formula.
model::PlantParameters Undisturbed() {
  return Nominal(
      {"load_motor_ripple", "load_unbalance", "motor_cogging", "position_periodic_friction", "output_drag"});
}

TEST(PhasorAtTurns, IsSineAndCosineOfAnyTurn) {
  for (int i = -2000; i <= 2000; ++i) {
    const double turns = 0.00137 * i + (i % 3 == 0 ? 70'000.0 : 0.0);
    const TurnPhasor phasor = PhasorAtTurns(turns);
    // What a share of so many turns is known to.
    const double within = 1e-15 + 4e-16 * std::abs(turns) * kTwoPi;
    const double angle_rad = kTwoPi * (turns - std::floor(turns));
    EXPECT_NEAR(phasor.sine, std::sin(angle_rad), within) << turns;
    EXPECT_NEAR(phasor.cosine, std::cos(angle_rad), within) << turns;
  }
  EXPECT_EQ(PhasorAtTurns(1.0).sine, 0.0);
  EXPECT_EQ(PhasorAtTurns(std::nextafter(1.0, 0.0)).cosine, 1.0);
}

TEST(GearPlant, WindsUpAsTheSpringSaysWhenLocked) {
  GearPlant plant(Nominal({"load_motor_ripple", "load_unbalance", "output_drag", "hysteresis", "creep",
                           "position_dependent_stiffness", "brake_compliance", "series_compliance"}));
  Hold(plant, Locked(0.0), 1.0);
  const double start = plant.state().output_rad;
  Hold(plant, Locked(34.0), 1.0);
  // 7/1.6e4 + 18/2.5e4 + 9/2.9e4
  EXPECT_NEAR(plant.state().output_rad - start, 1.4678e-3, 2e-7);
  EXPECT_NEAR(plant.state().gear_torque_Nm, 34.0, 1e-6);
}

TEST(GearPlant, AddsCouplingsTransducerAndBrakeInSeries) {
  GearPlant plant(Nominal({"load_motor_ripple", "load_unbalance", "output_drag", "hysteresis", "creep",
                           "position_dependent_stiffness"}));
  Hold(plant, Locked(0.0), 1.0);
  const double start = plant.state().output_rad;
  Hold(plant, Locked(34.0), 1.0);
  const double series = 34.0 * (1.0 / 4e4 + 1.0 / 3e4) + 34.0 / (80.0 * 80.0 * 1.5e4);
  EXPECT_NEAR(plant.state().output_rad - start, 1.4678e-3 + series, 2e-7);
}

TEST(GearPlant, RingsAtTheResonanceOfTheTwoInertias) {
  // Free input, no friction, no damping, one slope only: rings at f = (1/2π)·√(K(1/J_L + 1/(N²J_m))).
  model::PlantModel description =
      ModelWithout({"hysteresis", "creep", "position_dependent_stiffness", "coulomb_friction",
                    "stribeck_friction", "viscous_friction", "thermal_friction", "load_dependent_friction",
                    "flexspline_loss", "series_compliance", "output_drag", "load_unbalance",
                    "load_motor_ripple", "motor_cogging", "load_torque_lag"});
  model::FindParameter(description, "torsional_resonance", "damping_Nms_per_rad") = 0.0;
  const model::PlantParameters nominal = model::CompilePlantModel(description);
  GearPlant plant(nominal);
  PlantCommands free = Locked(0.0);
  free.input_brake = false;
  Hold(plant, free, 0.01, 1e-3);
  free.load_torque_Nm = 2.0;  // a push sets it ringing within the first slope
  plant.Step(free, 1e-3);
  free.load_torque_Nm = 0.0;
  int crossings = 0;
  double first_s = 0.0;
  double last_s = 0.0;
  double before = 0.0;
  constexpr double kStep_s = 1e-4;
  for (int i = 0; i < 20000; ++i) {
    plant.Step(free, kStep_s);
    const double now = plant.state().gear_torque_Nm;
    if (before < 0.0 && now >= 0.0) {
      last_s = kStep_s * (i + before / (before - now));
      if (crossings++ == 0) first_s = last_s;
    }
    before = now;
  }
  ASSERT_GT(crossings, 20);
  const double measured_Hz = (crossings - 1) / (last_s - first_s);
  const double expected_Hz =
      std::sqrt(1.6e4 * (1.0 / nominal.inertia.output_kgm2 + 1.0 / (6400.0 * nominal.inertia.input_kgm2))) /
      kTwoPi;
  EXPECT_NEAR(measured_Hz, expected_Hz, 0.003 * expected_Hz);
}

TEST(GearPlant, GivesTheSameLoopInShortAndLongSteps) {
  const model::PlantParameters nominal = Nominal();
  GearPlant fine(nominal);
  GearPlant coarse(nominal);
  Hold(fine, Locked(0.0), 1.0, 1e-3);
  Hold(coarse, Locked(0.0), 1.0, 1e-2);
  double worst_rad = 0.0;
  for (int i = 0; i < 8000; ++i) {
    const double torque = 34.0 * std::sin(kTwoPi * i / 4000.0);
    Hold(fine, Locked(torque), 0.01, 1e-3);
    Hold(coarse, Locked(torque), 0.01, 1e-2);
    worst_rad = std::max(worst_rad, std::abs(fine.state().output_rad - coarse.state().output_rad));
  }
  // Of a loop that is 7e-3 rad high.
  EXPECT_LT(worst_rad, 2e-5);
}

TEST(GearPlant, NeedsTheSameMotorTorqueInShortAndLongSteps) {
  const model::PlantParameters nominal = Undisturbed();
  GearPlant fine(nominal);
  GearPlant coarse(nominal);
  const auto mean_torque = [](GearPlant& plant, double step_s) {
    Hold(plant, AtSpeed(100.0, -30.0), 0.5, step_s);
    double sum = 0.0;
    const int steps = static_cast<int>(std::lround(kTwoPi * 80.0 / 100.0 / step_s));
    for (int i = 0; i < steps; ++i) {
      plant.Step(AtSpeed(100.0, -30.0), step_s);
      sum += plant.state().motor_torque_Nm;
    }
    return sum / steps;
  };
  const double quasi_static_Nm = mean_torque(coarse, 1e-2);
  EXPECT_NEAR(mean_torque(fine, 1e-3), quasi_static_Nm, 0.01 * quasi_static_Nm);
}

TEST(GearPlant, TurnsTheOutputOnceInEightyTurns) {
  for (const double step_s : {1e-3, 1e-2}) {
    GearPlant plant(Nominal());
    Hold(plant, AtSpeed(0.0, -20.0), 1.0, step_s);
    const PlantState before = plant.state();
    Hold(plant, AtSpeed(100.0, -20.0), 5.0, step_s);
    Hold(plant, AtSpeed(0.0, -20.0), 1.0, step_s);
    const double turned = plant.state().input_rad - before.input_rad;
    EXPECT_NEAR(turned, 500.0, 5.0);
    EXPECT_NEAR(plant.state().output_rad - before.output_rad, turned / 80.0, 1e-3);
  }
}

TEST(GearPlant, LosesAQuarterOfThePowerAtRatedLoad) {
  GearPlant plant(Undisturbed());
  plant.SetGearTemperature(25.0);
  Hold(plant, AtSpeed(RadPerSFromRpm(2000.0), -34.0), 1.0);
  const double efficiency = -plant.state().gear_torque_Nm / 80.0 / plant.state().motor_torque_Nm;
  EXPECT_GT(efficiency, 0.70);
  EXPECT_LT(efficiency, 0.80);
}

TEST(GearPlant, WarmsUpToWhereItsLossesGo) {
  GearPlant plant(Nominal({"day_and_night", "motor_cogging", "position_periodic_friction"}));
  const PlantCommands commands = AtSpeed(RadPerSFromRpm(2400.0), -40.0);
  Hold(plant, commands, 6.0 * 3600.0, 0.05);
  const PlantState before = plant.state();
  // The mean loss over some turns, from the balance of power and not from the friction law.
  double loss_J = 0.0;
  constexpr double kStep_s = 0.013;
  for (int i = 0; i < 20000; ++i) {
    plant.Step(commands, kStep_s);
    const PlantState& s = plant.state();
    loss_J += kStep_s * (s.motor_torque_Nm + s.gear_torque_Nm / 80.0) * s.input_speed_rad_per_s;
  }
  const double loss_W = loss_J / (plant.state().time_s - before.time_s);
  EXPECT_GT(loss_W, 20.0);
  EXPECT_NEAR(plant.state().thermal.gear_degC - 22.0, loss_W * (0.35 + 0.45), 0.5);
}

TEST(GearPlant, HoldsItsInputWithTheBrake) {
  GearPlant plant(Nominal());
  Hold(plant, Locked(0.0), 1.0);
  const double start = plant.state().input_rad;
  Hold(plant, Locked(60.0), 2.0);
  // Only the brake's compliance: 60/80 Nm on 15000 Nm/rad.
  EXPECT_NEAR(plant.state().input_rad - start, 60.0 / 80.0 / 1.5e4, 5e-6);
}

TEST(GearPlant, SlipsBeyondWhatTheBrakeHolds) {
  for (const double step_s : {1e-3, 1e-2}) {
    model::PlantModel description = ModelWithout({});
    model::FindParameter(description, "brake_slip", "holding_torque_Nm") = 0.3;  // 24 Nm at the output
    GearPlant plant(model::CompilePlantModel(description));
    Hold(plant, Locked(20.0), 2.0, step_s);
    const double held = plant.state().input_rad;
    Hold(plant, Locked(34.0), 1.0, step_s);
    const double slipped = plant.state().input_rad - held;
    EXPECT_GT(slipped, 0.05);
    Hold(plant, Locked(0.0), 2.0, step_s);
    EXPECT_GT(plant.state().input_rad - held, 0.9 * slipped);  // does not come back
  }
}

TEST(GearPlant, ComesToRestUnwoundAfterTorqueOffAtFullLoad) {
  GearPlant plant(Nominal());
  Hold(plant, AtSpeed(RadPerSFromRpm(2400.0), -40.0), 1.0);
  const PlantCommands off;  // torque off, brakes on
  Hold(plant, off, 3.0);
  EXPECT_TRUE(plant.state().input_brake_closed);
  EXPECT_TRUE(plant.state().load_brake_closed);
  EXPECT_NEAR(plant.state().input_speed_rad_per_s, 0.0, 1e-9);
  EXPECT_LT(std::abs(plant.state().gear_torque_Nm), 3.0);
}

TEST(GearPlant, UnwindsBeforeItIsLockedAtBothEnds) {
  for (const double step_s : {1e-3, 1e-2}) {
    GearPlant plant(Nominal());
    Hold(plant, AtSpeed(0.0, -40.0), 1.0, step_s);
    const PlantCommands off;  // torque off, brakes on, from standstill under load
    Hold(plant, off, 2.0, step_s);
    EXPECT_TRUE(plant.state().load_brake_closed);
    EXPECT_LT(std::abs(plant.state().gear_torque_Nm), 1.0);
  }
}

TEST(GearPlant, DragsItsFeetByTheTorqueOfTheLoadTrain) {
  GearPlant plant(Nominal({"load_motor_ripple", "load_unbalance"}));
  Hold(plant, AtSpeed(20.0, 0.0), 2.0);
  const double forward = plant.state().gear_torque_Nm;
  Hold(plant, AtSpeed(-20.0, 0.0), 2.0);
  EXPECT_NEAR(forward, -0.5 - 0.05 * 20.0 / 80.0, 1e-6);
  EXPECT_NEAR(plant.state().gear_torque_Nm, -forward, 1e-6);
}

TEST(GearPlant, IsARigidOneToOneShaftWithTheBlank) {
  GearPlant plant(Nominal({"load_motor_ripple", "load_unbalance", "output_drag"}));
  plant.MountBlank(true);
  Hold(plant, Locked(0.0), 1.0);
  const PlantState before = plant.state();
  Hold(plant, Locked(34.0), 1.0);
  EXPECT_EQ(plant.state().input_rad, before.input_rad);
  EXPECT_NEAR(plant.state().output_rad - before.output_rad, 34.0 * (1.0 / 4e4 + 1.0 / 3e4), 1e-6);
  Hold(plant, AtSpeed(0.0, 0.0), 1.0);
  const PlantState free = plant.state();
  Hold(plant, AtSpeed(1.0, 0.0), 3.0);
  EXPECT_NEAR(plant.state().output_rad - free.output_rad, plant.state().input_rad - free.input_rad, 1e-6);
  EXPECT_EQ(plant.state().input_revolutions, before.input_revolutions);  // the gear is not worn meanwhile
}

TEST(GearPlant, TurnsTheBlankNoHarderThanItsServoCan) {
  GearPlant plant(Nominal());
  plant.MountBlank(true);
  PlantCommands commands = AtSpeed(0.0, 0.0);
  commands.input = Input::kPosition;
  Hold(plant, commands, 0.1);
  commands.input_set_point = 0.5;
  double hardest = 0.0;
  for (int i = 0; i < 200; ++i) {
    plant.Step(commands, 0.01);
    hardest = std::max(hardest, std::abs(plant.state().gear_torque_Nm));
  }
  EXPECT_LT(hardest, 7.16 + 1.0);  // and the drag of the load train
  EXPECT_NEAR(plant.state().input_rad, 0.5, 1e-4);
  EXPECT_NEAR(plant.state().input_speed_rad_per_s, 0.0, 1e-3);
}

TEST(GearPlant, CannotBeForcedBeyondThePeakTorqueOfItsServo) {
  GearPlant plant(Nominal());
  Hold(plant, AtSpeed(0.0, 0.0), 0.5);
  PlantCommands commands = AtSpeed(1e6, 0.0);
  for (int i = 0; i < 200; ++i) {
    plant.Step(commands, 1e-3);
    EXPECT_LE(std::abs(plant.state().motor_torque_Nm), 7.16 + 1e-12);
  }
  EXPECT_LE(plant.state().input_speed_rad_per_s, RadPerSFromRpm(6000.0) * 1.05);
}

}  // namespace
}  // namespace strainwave::bench::simulated_plant_test
