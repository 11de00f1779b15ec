// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <complex>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/bench/causes_helpers.h"

namespace strainwave::bench::simulated_drive_causes_test {
namespace {

// Motor torque at a steady speed, quasi-static, mean over whole turns.
double MotorTorque(GearPlant& plant, double speed_rad_per_s, double load_Nm = 0.0) {
  Hold(plant, Driven(Input::kSpeed, speed_rad_per_s, load_Nm), 0.5);
  const double step_s = kTwoPi / std::abs(speed_rad_per_s) / 8.0;
  double sum = 0.0;
  for (int i = 0; i < 8 * 80; ++i) {
    plant.Step(Driven(Input::kSpeed, speed_rad_per_s, load_Nm), step_s);
    sum += plant.state().motor_torque_Nm;
  }
  return sum / (8 * 80);
}

// A·sin(order·θ + φ) in a signal over whole turns: projection on cosine and sine.
std::complex<double> Projected(const std::vector<double>& angle_rad, const std::vector<double>& signal,
                               double order) {
  std::complex<double> sum;
  for (std::size_t i = 0; i < signal.size(); ++i) sum += signal[i] * std::polar(1.0, -order * angle_rad[i]);
  return 2.0 * sum / static_cast<double>(signal.size()) * std::complex<double>(0.0, 1.0);
}

TEST(SimulatedFriction, DiffersByDirectionInItsViscousPart) {
  GearPlant plant = Plant({{"asymmetric_viscous_friction", "difference_Nms_per_rad", 2e-4}});
  GearPlant nominal = Plant({});
  for (const double speed : {50.0, 150.0}) {
    EXPECT_NEAR(MotorTorque(plant, speed) - MotorTorque(nominal, speed), 1e-4 * speed, 1e-7);
    EXPECT_NEAR(MotorTorque(plant, -speed) - MotorTorque(nominal, -speed), 1e-4 * speed, 1e-7);
  }
}

TEST(SimulatedFriction, RisesWithTheSquareOfTheSpeed) {
  GearPlant plant = Plant({{"quadratic_drag", "drag_Nms2_per_rad2", 3e-6}});
  GearPlant nominal = Plant({});
  for (const double speed : {50.0, -50.0, 200.0}) {
    EXPECT_NEAR(MotorTorque(plant, speed) - MotorTorque(nominal, speed), 3e-6 * speed * std::abs(speed),
                1e-7);
  }
}

TEST(SimulatedFriction, DriftsWithTemperatureAsAWhole) {
  GearPlant plant =
      Plant({{"friction_drift", "share_per_K", -0.02}, {"friction_drift", "reference_degC", 22.0}});
  GearPlant nominal = Plant({});
  plant.SetGearTemperature(32.0);
  nominal.SetGearTemperature(32.0);
  const double torque_Nm = MotorTorque(nominal, 100.0);
  const double drifted_Nm = MotorTorque(plant, 100.0);
  const double warmer_K = plant.state().thermal.gear_degC - 22.0;
  EXPECT_GT(warmer_K, 9.0);
  EXPECT_NEAR(drifted_Nm, (1.0 - 0.02 * warmer_K) * torque_Nm, 0.003 * torque_Nm);
}

TEST(SimulatedDriveCauses, FeelsATorqueOfAnyOrder) {
  GearPlant plant = Plant({{"input_periodic_torque", "amplitude_Nm", 0.03},
                           {"input_periodic_torque", "order_per_turn", 13.5},
                           {"input_periodic_torque", "phase_rad", 0.6},
                           {"input_unbalance", "amplitude_Nm", 0.02},
                           {"input_unbalance", "phase_rad", -1.0}});
  const PlantCommands commands = Driven(Input::kSpeed, 4.0);
  Hold(plant, commands, 0.5);
  std::vector<double> angle_rad, torque_Nm;
  constexpr int kStepsPerTurn = 100;
  for (int i = 0; i < kStepsPerTurn * 80; ++i) {
    plant.Step(commands, kTwoPi / 4.0 / kStepsPerTurn);
    angle_rad.push_back(plant.state().input_rad);
    torque_Nm.push_back(plant.state().motor_torque_Nm);
  }
  const std::complex<double> ripple = Projected(angle_rad, torque_Nm, 13.5);
  EXPECT_NEAR(std::abs(ripple), 0.03, 2e-4);
  EXPECT_NEAR(std::arg(ripple), 0.6, 0.01);
  const std::complex<double> weight = Projected(angle_rad, torque_Nm, 1.0);
  EXPECT_NEAR(std::abs(weight), 0.02, 2e-4);
  EXPECT_NEAR(std::arg(weight), -1.0, 0.01);
}

TEST(SimulatedDriveCauses, IsDisturbedInWindowsOfTheMeasurement) {
  for (const double step_s : {0.001, 0.01}) {
    GearPlant plant = Plant({{"external_disturbance", "torque_Nm", 0.25},
                             {"external_disturbance", "start_s", 2.0},
                             {"external_disturbance", "end_s", 3.0},
                             {"external_disturbance", "torque_3_Nm", -0.1},
                             {"external_disturbance", "start_3_s", 5.0},
                             {"external_disturbance", "end_3_s", 6.0},
                             {"input_constant_torque", "torque_Nm", 0.05}});
    GearPlant nominal = Plant({});
    const PlantCommands commands = Driven(Input::kSpeed, 60.0);
    for (GearPlant* one : {&plant, &nominal}) {
      Hold(*one, commands, 10.0, step_s);
      one->SetState(one->state());  // a measurement begins
    }
    const auto difference = [&](double until_s) {
      Hold(plant, commands, until_s - plant.measurement_time_s(), step_s);
      Hold(nominal, commands, until_s - nominal.measurement_time_s(), step_s);
      double sum = 0.0;
      constexpr int kMean = 40;
      for (int i = 0; i < kMean; ++i) {
        plant.Step(commands, step_s);
        nominal.Step(commands, step_s);
        sum += plant.state().motor_torque_Nm - nominal.state().motor_torque_Nm;
      }
      return sum / kMean;
    };
    EXPECT_NEAR(difference(1.4), 0.05, 0.003);
    EXPECT_NEAR(difference(2.5), 0.30, 0.003);
    EXPECT_NEAR(difference(4.4), 0.05, 0.003);
    EXPECT_NEAR(difference(5.5), -0.05, 0.003);
  }
}

TEST(SimulatedDriveCauses, ActsLateByItsDelay) {
  constexpr double kStep_s = 0.00025;
  const auto speeds = [](double delay_s) {
    GearPlant plant = Plant({{"drive_time_delay", "delay_s", delay_s}});
    Hold(plant, Driven(Input::kTorque, 0.0), 0.1, kStep_s);
    std::vector<double> speed;
    for (int i = 0; i < 400; ++i) {
      plant.Step(Driven(Input::kTorque, 0.3), kStep_s);
      EXPECT_EQ(plant.state().motor_torque_Nm, 0.3);  // what the drive says
      speed.push_back(plant.state().input_speed_rad_per_s);
    }
    return speed;
  };
  const std::vector<double> prompt = speeds(0.0);
  const std::vector<double> late = speeds(0.006);
  EXPECT_NEAR(late[23], 0.0, 1e-6);
  for (std::size_t i = 24; i < late.size(); ++i) ASSERT_NEAR(late[i], prompt[i - 24], 0.02) << i;
}

TEST(SimulatedBrake, GivesWayInEveryForm) {
  // Holds 16 Nm at the output; loaded to 24 Nm, off, to 24 Nm and to 32 Nm, a second each.
  const auto slips = [](std::string_view form, double value) {
    GearPlant plant = Plant({{"brake_slip", "holding_torque_Nm", 0.2},
                             {"brake_slip", "slip_damping_Nms_per_rad", 1e9},
                             {"brake_yield", form, value}});
    Hold(plant, Locked(0.0), 1.0);
    std::array<double, 3> slipped{};
    std::size_t loading = 0;
    double before = plant.state().brake_anchor_rad;
    for (const double load_Nm : {24.0, 24.0, 32.0}) {
      Hold(plant, Locked(load_Nm), 1.0);
      Hold(plant, Locked(0.0), 1.0);
      slipped[loading++] = plant.state().brake_anchor_rad - before;
      before = plant.state().brake_anchor_rad;
    }
    return slipped;
  };
  // Beyond at the shaft: 0.1, 0.1 and 0.2 Nm.
  const auto further = slips("only_further_rad_per_Nm", 3.0);
  EXPECT_NEAR(further[0], 0.3, 1e-3);
  EXPECT_NEAR(further[1], 0.0, 1e-3);
  EXPECT_NEAR(further[2], 0.3, 1e-3);
  const auto each = slips("each_time_rad_per_Nm", 3.0);
  EXPECT_NEAR(each[0], 0.3, 1e-3);
  EXPECT_NEAR(each[1], 0.3, 1e-3);
  EXPECT_NEAR(each[2], 0.6, 1e-3);
  const auto once = slips("once_rad", 0.5);
  EXPECT_NEAR(once[0], 0.5, 1e-9);
  EXPECT_NEAR(once[1] + once[2], 0.0, 1e-9);
  const auto speed = slips("speed_rad_per_s", 0.2);
  for (const double slipped : speed) EXPECT_NEAR(slipped, 0.2, 0.01);
}

}  // namespace
}  // namespace strainwave::bench::simulated_drive_causes_test
