// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/bench/causes_helpers.h"

namespace strainwave::bench::simulated_causes_test {
namespace {

constexpr std::string_view kCauses[] = {"gear_backlash",
                                        "asymmetric_stiffness",
                                        "cubic_hardening",
                                        "distributed_friction",
                                        "rate_dependence",
                                        "exponential_creep",
                                        "local_tooth_damage",
                                        "friction_drift",
                                        "asymmetric_viscous_friction",
                                        "quadratic_drag",
                                        "input_periodic_torque",
                                        "input_unbalance",
                                        "input_constant_torque",
                                        "external_disturbance",
                                        "brake_yield",
                                        "drive_time_delay",
                                        "torque_zero_offset",
                                        "output_thermal_drift",
                                        "output_time_drift",
                                        "output_swing_drift",
                                        "vibration_bearing_defect",
                                        "vibration_imbalance",
                                        "vibration_flexspline_crack",
                                        "vibration_torsional_resonance"};

// Torque up or down at a rate, input locked.
double Ramp(GearPlant& plant, double from_Nm, double to_Nm, double rate_Nm_per_s, double step_s = 0.01) {
  const int steps = static_cast<int>(std::lround(std::abs(to_Nm - from_Nm) / rate_Nm_per_s / step_s));
  for (int i = 1; i <= steps; ++i) plant.Step(Locked(from_Nm + (to_Nm - from_Nm) * i / steps), step_s);
  return plant.state().output_rad;
}

// Width of a loop to ±30 Nm at zero torque.
double LoopWidth(GearPlant& plant, double rate_Nm_per_s, double step_s = 0.01) {
  Ramp(plant, 0.0, 30.0, rate_Nm_per_s, step_s);
  const double falling = Ramp(plant, 30.0, 0.0, rate_Nm_per_s, step_s);
  Ramp(plant, 0.0, -30.0, rate_Nm_per_s, step_s);
  return falling - Ramp(plant, -30.0, 0.0, rate_Nm_per_s, step_s);
}

TEST(SimulatedCauses, LeaveEveryBitAsItIsWhileTheyAreOff) {
  model::PlantModel without = model::DefaultPlantModel();
  for (const std::string_view cause : kCauses) {
    model::FindTerm(without, cause);  // is there
    std::erase_if(without.terms, [&](const model::Term& term) { return term.name == cause; });
  }
  SimulatedBench listed(model::DefaultPlantModel(), {.seed = 4});
  SimulatedBench left_out(without, {.seed = 4});
  std::vector<double> values[2];
  int which = 0;
  for (SimulatedBench* bench : {&listed, &left_out}) {
    std::vector<double>& seen = values[which++];
    const auto read = [&] {
      const Readings r = bench->sampler().Read();
      seen.insert(seen.end(),
                  {r.input_angle_rad, r.output_angle_rad, r.input_speed_rad_per_s, r.output_torque_Nm,
                   r.motor_torque_Nm, r.gear_temperature_degC, r.vibration_rms_m_per_s2});
    };
    for (const int period_ms : {1, 10}) {
      Driver driver(*bench, std::chrono::milliseconds(period_ms));
      driver.BringUp(DriveMode::kSpeed);
      bench->load_servo().CommandTorque(-20.0);
      bench->driving_servo().CommandSpeed(150.0);
      bench->sampler().StartVibration(25600.0);
      for (int i = 0; i < 300; ++i) {
        driver.Steps(1);
        read();
      }
      VibrationBlock block;
      bench->sampler().DrainVibration(block);
      seen.insert(seen.end(), block.accel_z_m_per_s2.begin(), block.accel_z_m_per_s2.end());
      bench->sampler().StopVibration();
      bench->driving_servo().CommandSpeed(0.0);
      bench->load_servo().CommandTorque(0.0);
      driver.Wait(0.5);
      driver.LockInput();
      double torque_Nm = 0.0;
      for (const double target_Nm : {20.0, -20.0, 0.0}) {
        driver.Ramp(torque_Nm, target_Nm, 20.0);
        read();
      }
      bench->driving_servo().QuickStop();
      bench->load_servo().QuickStop();
      driver.Wait(2.0);
    }
  }
  EXPECT_EQ(values[0], values[1]);
}

TEST(SimulatedBacklash, IsADeadZoneOfALockTest) {
  const auto between = [](double width_rad, double step_s) {
    GearPlant plant =
        Plant({{"gear_backlash", "width_rad", width_rad}, {"hysteresis", "friction_torque_Nm", 0.0}});
    Hold(plant, Locked(0.5), 1.0, step_s);
    const double above = plant.state().output_rad;
    Hold(plant, Locked(-0.5), 1.0, step_s);
    return above - plant.state().output_rad;
  };
  EXPECT_NEAR(between(4e-4, 0.01) - between(0.0, 0.01), 4e-4, 1e-9);
  // Integrated, it has settled to a small part of the width after a second.
  EXPECT_NEAR(between(4e-4, 0.001) - between(0.0, 0.001), 4e-4, 2e-6);
}

TEST(SimulatedBacklash, IsADifferenceBetweenTheDirections) {
  const auto difference = [](double width_rad) {
    GearPlant plant = Plant({{"gear_backlash", "width_rad", width_rad}});
    const auto error = [&](double from_rad) {
      Hold(plant, Driven(Input::kPosition, from_rad, 0.0), 2.0);
      Hold(plant, Driven(Input::kPosition, 40.0, 0.0), 2.0);
      return plant.state().input_rad / 80.0 - plant.state().output_rad;
    };
    // Something has to hold the output back: a load against the motion.
    const auto loaded = [&](double from_rad, double load_Nm) {
      Hold(plant, Driven(Input::kPosition, from_rad, load_Nm), 2.0);
      Hold(plant, Driven(Input::kPosition, 40.0, load_Nm), 2.0);
      return plant.state().input_rad / 80.0 - plant.state().output_rad;
    };
    error(0.0);
    return loaded(20.0, -1.0) - loaded(60.0, 1.0);
  };
  EXPECT_NEAR(difference(3e-4) - difference(0.0), 3e-4, 1e-9);
}

TEST(SimulatedBacklash, LosesContactAtAReversal) {
  // Input travel from a reversal to where the drag on the output has slipped the other way.
  const auto travel_rad = [](double width_rad, double step_s) {
    GearPlant plant = Plant({{"gear_backlash", "width_rad", width_rad}, {"output_drag", "drag_Nm", 0.5}});
    Hold(plant, Driven(Input::kSpeed, 4.0), 3.0, step_s);
    Hold(plant, Driven(Input::kSpeed, 0.0), 1.0, step_s);
    const PlantState turned = plant.state();
    while (plant.state().output_rad > turned.output_rad - 2e-3) {
      plant.Step(Driven(Input::kSpeed, -4.0), step_s);
    }
    return turned.input_rad - plant.state().input_rad;
  };
  // To a step's travel.
  EXPECT_NEAR(travel_rad(2e-3, 0.01) - travel_rad(0.0, 0.01), 80.0 * 2e-3, 0.045);
  EXPECT_NEAR(travel_rad(2e-3, 0.001) - travel_rad(0.0, 0.001), 80.0 * 2e-3, 0.02);
}

TEST(SimulatedStiffness, DiffersBetweenTheSides) {
  GearPlant plant = Plant({{"asymmetric_stiffness", "asymmetry_share", 0.08},
                           {"hysteresis", "friction_torque_Nm", 0.0},
                           {"series_compliance", "transducer_rad_per_Nm", 0.0},
                           {"series_compliance", "couplings_rad_per_Nm", 0.0},
                           {"brake_compliance", "compliance_rad_per_Nm", 0.0}});
  Hold(plant, Locked(0.0), 1.0);
  const double zero = plant.state().output_rad;
  const auto slope = [&](double sign) {
    Hold(plant, Locked(10.0 * sign), 0.5);
    const double near = plant.state().output_rad;
    Hold(plant, Locked(20.0 * sign), 0.5);
    return 10.0 * sign / (plant.state().output_rad - near);
  };
  EXPECT_NEAR(slope(1.0), 1.08 * 2.5e4, 1.0);
  EXPECT_NEAR(slope(-1.0), 0.92 * 2.5e4, 1.0);
  Hold(plant, Locked(0.0), 0.5);
  EXPECT_NEAR(plant.state().output_rad, zero, 1e-9);
}

TEST(SimulatedStiffness, RisesWithTheCubeOfTheTwist) {
  GearPlant plant =
      Plant({{"cubic_hardening", "hardening_Nm_per_rad3", 4e9}, {"hysteresis", "friction_torque_Nm", 0.0}});
  Hold(plant, Locked(0.0), 1.0);
  Hold(plant, Locked(34.0), 1.0);
  const double twist = plant.state().twist_rad;
  // 7/1.6e4 + 18/2.5e4 = 1.1575e-3 rad at the second knee.
  EXPECT_NEAR(25.0 + 2.9e4 * (twist - 1.1575e-3) + 4e9 * twist * twist * twist, 34.0, 1e-6);
}

TEST(SimulatedHysteresis, WidensWithEachElement) {
  GearPlant plain = Plant({{"hysteresis", "friction_torque_Nm", 1.0}});
  GearPlant spectrum = Plant({{"hysteresis", "friction_torque_Nm", 1.0},
                              {"distributed_friction", "second_friction_torque_Nm", 0.8},
                              {"distributed_friction", "second_yield_twist_rad", 3e-4},
                              {"distributed_friction", "third_friction_torque_Nm", 0.5},
                              {"distributed_friction", "third_yield_twist_rad", 5e-4}});
  // In the first slope, the spring alone at zero torque in all.
  EXPECT_NEAR(LoopWidth(plain, 10.0), 2.0 * 1.0 / 1.6e4, 1e-9);
  EXPECT_NEAR(LoopWidth(spectrum, 10.0), 2.0 * 2.3 / 1.6e4, 1e-9);
}

TEST(SimulatedHysteresis, WidensWithTheRateOfTheTorque) {
  const auto width = [](double viscous_Nms_per_rad, double rate_Nm_per_s, double step_s) {
    GearPlant plant = Plant({{"rate_dependence", "viscous_Nms_per_rad", viscous_Nms_per_rad}});
    return LoopWidth(plant, rate_Nm_per_s, step_s);
  };
  // A lag of c·r/K² in the first slope, on either side.
  const double expected = 2.0 * 1000.0 * 4.0 / (1.6e4 * 1.6e4);
  EXPECT_NEAR(width(1000.0, 4.0, 0.01) - width(0.0, 4.0, 0.01), expected, 0.03 * expected);
  EXPECT_NEAR(width(1000.0, 1.0, 0.01) - width(0.0, 1.0, 0.01), 0.25 * expected, 0.01 * expected);
}

TEST(SimulatedHysteresis, StaysStableInShortStepsHoweverViscous) {
  GearPlant plant = Plant({{"rate_dependence", "viscous_Nms_per_rad", 1e5}});
  for (int i = 0; i < 4000; ++i) {
    plant.Step(Driven(Input::kSpeed, i < 2000 ? 50.0 : -50.0, 10.0), 0.001);
    ASSERT_LT(std::abs(plant.state().gear_torque_Nm), 30.0) << i;
  }
  EXPECT_NEAR(plant.state().input_speed_rad_per_s, -50.0, 1.0);
}

TEST(SimulatedCreep, GoesOnWithItsTimeConstant) {
  for (const double step_s : {0.001, 0.01}) {
    GearPlant plant = Plant({{"exponential_creep", "compliance_rad_per_Nm", 4e-6},
                             {"exponential_creep", "time_constant_s", 5.0}});
    Hold(plant, Locked(0.0), 1.0, step_s);
    Hold(plant, Locked(30.0), 2.0, step_s);  // and has stopped ringing
    const double start = plant.state().output_rad;
    Hold(plant, Locked(30.0), 5.0, step_s);
    const double expected = 30.0 * 4e-6 * std::exp(-2.0 / 5.0) * (1.0 - std::exp(-1.0));
    EXPECT_NEAR(plant.state().output_rad - start, expected, 0.02 * expected);
  }
}

TEST(SimulatedToothDamage, IsABumpOfTheTransmissionError) {
  GearPlant whole = Plant({});
  GearPlant damaged = Plant({{"local_tooth_damage", "height_rad", 6e-5},
                             {"local_tooth_damage", "centre_rad", RadFromDeg(40.0)},
                             {"local_tooth_damage", "width_rad", RadFromDeg(5.0)}});
  const auto error = [](GearPlant& plant, double output_deg) {
    Hold(plant, Driven(Input::kPosition, 80.0 * RadFromDeg(output_deg)), 2.0);
    return plant.state().input_rad / 80.0 - plant.state().output_rad;
  };
  for (const auto& [output_deg, share] :
       {std::pair{30.0, 0.0}, {37.5, 0.5}, {40.0, 1.0}, {42.5, 0.5}, {50.0, 0.0}}) {
    EXPECT_NEAR(error(damaged, output_deg) - error(whole, output_deg), share * 6e-5, 1e-7) << output_deg;
  }
}

TEST(SimulatedTransducer, ShowsAZeroOffsetThatTheGearDoesNotHave) {
  SimulatedBench shifted(Quiet({{"torque_zero_offset", "offset_Nm", 0.7}}), {.seed = 4});
  SimulatedBench nominal(Quiet({}), {.seed = 4});
  for (SimulatedBench* bench : {&shifted, &nominal}) {
    Driver driver(*bench);
    driver.LockInput();
    double torque_Nm = 0.0;
    driver.Ramp(torque_Nm, 10.0, 10.0);
    driver.Wait(0.5);
  }
  EXPECT_NEAR(shifted.sampler().Read().output_torque_Nm - nominal.sampler().Read().output_torque_Nm, 0.7,
              1e-9);
  EXPECT_EQ(shifted.Memory().plant.gear_torque_Nm, nominal.Memory().plant.gear_torque_Nm);
}

TEST(SimulatedDrift, FollowsTheGearsTemperature) {
  const auto moved = [](double drift_rad_per_K) {
    SimulatedBench bench(Quiet({{"output_thermal_drift", "drift_rad_per_K", drift_rad_per_K}}), {.seed = 4});
    Driver(bench).Steps(1);
    const double cold = bench.sampler().Read().output_angle_rad;
    bench.Inject({.gear_temperature_degC = 32.0});
    Driver(bench).Steps(1);
    return bench.sampler().Read().output_angle_rad - cold;
  };
  // From the room's 22 degrees; to the encoder's resolution.
  EXPECT_NEAR(moved(3e-6) - moved(0.0), 3e-5, 5e-8);
}

TEST(SimulatedDrift, FollowsTheTimeSinceTheMeasurementBegan) {
  const auto readings = [](double rate_rad_per_s) {
    SimulatedBench bench(Quiet({{"output_time_drift", "rate_rad_per_s", rate_rad_per_s},
                                {"output_time_drift", "time_constant_s", 20.0}}),
                         {.seed = 4});
    Driver driver(bench);
    driver.Wait(30.0);
    bench.BeginPhase(7);
    std::array<double, 2> seen{bench.sampler().Read().output_angle_rad, 0.0};
    driver.Wait(20.0);
    seen[1] = bench.sampler().Read().output_angle_rad;
    return seen;
  };
  const auto drifting = readings(2e-6);
  const auto still = readings(0.0);
  EXPECT_NEAR(drifting[0] - still[0], 0.0, 5e-8);
  EXPECT_NEAR(drifting[1] - still[1], 2e-6 * 20.0 * (1.0 - std::exp(-1.0)), 5e-8);
}

// A quarter of its period from where its sine is highest: down by once its size.
TEST(SimulatedDrift, SwingsAboutWhereTheMeasurementBegan) {
  const auto moved_in_20_s = [](double swing_rad) {
    SimulatedBench bench(Quiet({{"output_swing_drift", "swing_rad", swing_rad},
                                {"output_swing_drift", "period_s", 80.0},
                                {"output_swing_drift", "phase_rad", 0.5 * kPi}}),
                         {.seed = 4});
    Driver driver(bench);
    driver.Wait(30.0);
    bench.BeginPhase(7);
    const double begun = bench.sampler().Read().output_angle_rad;
    driver.Wait(20.0);
    return bench.sampler().Read().output_angle_rad - begun;
  };
  EXPECT_NEAR(moved_in_20_s(3e-5) - moved_in_20_s(0.0), -3e-5, 1e-7);
}

}  // namespace
}  // namespace strainwave::bench::simulated_causes_test
