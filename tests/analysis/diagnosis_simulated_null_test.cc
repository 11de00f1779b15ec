// SPDX-License-Identifier: Apache-2.0
// Claims judged by records that are simulated without their cause.
#include "analysis/diagnosis/simulated_null.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/diagnosis/motion/simulated_axis.h"
#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis_simulated_null_test {
namespace {

using diagnosis::MotionData;
using diagnosis::NamedClaim;
using diagnosis::NullEvidence;

// To and fro, without noise of its own.
MotionData Measured() {
  MotionData record;
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.002 * i;
    record.time_s.push_back(t);
    record.position.push_back(0.5 * std::sin(2.0 * std::numbers::pi * 0.5 * t));
    record.torque.push_back(0.1 * ((i * 7919) % 13 - 6));
  }
  return record;
}

const diagnosis::AxisNumbers kNumbers{0.02, 0.05, 0.4, 0.1};

TEST(SimulatedAxis, FollowsThePathWithTheTorqueOfItsNumbers) {
  const MotionData measured = Measured();
  const auto simulated = diagnosis::SimulateAxis(measured, kNumbers, 3);
  ASSERT_TRUE(simulated.has_value());
  EXPECT_EQ(simulated->time_s, measured.time_s);
  // Inverse dynamics in closed form, away from reversals and from the start.
  double square = 0.0;
  int count = 0;
  for (std::size_t i = 500; i < measured.time_s.size(); ++i) {
    EXPECT_NEAR(simulated->position[i], measured.position[i], 0.01) << i;
    const double w = 2.0 * std::numbers::pi * 0.5;
    const double velocity = 0.5 * w * std::cos(w * measured.time_s[i]);
    if (std::abs(velocity) < 0.5) continue;
    const double torque = -kNumbers.inertia * w * w * measured.position[i] + kNumbers.viscous * velocity +
                          std::copysign(kNumbers.coulomb, velocity) + kNumbers.offset;
    square += std::pow(simulated->torque[i] - torque, 2);
    ++count;
  }
  ASSERT_GT(count, 1000);
  EXPECT_LT(std::sqrt(square / count), 0.01) << "of 0.6 Nm";
}

TEST(SimulatedAxis, IsAnotherForEachDrawAndTheSameForTheSame) {
  const MotionData measured = Measured();
  const auto first = diagnosis::SimulateAxis(measured, kNumbers, 3);
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(diagnosis::SimulateAxis(measured, kNumbers, 3)->torque, first->torque);
  EXPECT_NE(diagnosis::SimulateAxis(measured, kNumbers, 4)->torque, first->torque);
}

TEST(SimulatedAxis, IsNoneOfNumbersThatNoAxisHas) {
  EXPECT_FALSE(diagnosis::SimulateAxis(Measured(), {-0.02, 0.05, 0.4, 0.1}, 3).has_value());
  EXPECT_FALSE(diagnosis::SimulateAxis(Measured(), {0.02, -0.05, 0.4, 0.1}, 3).has_value());
}

// Each simulated record claims `delta_bic`, of this name.
NullEvidence Judged(const NamedClaim& claim, const std::string& name, double delta_bic, int& simulated) {
  const MotionData measured = Measured();
  const auto simulate = [&](std::span<const diagnosis::ParameterValue>, std::uint64_t) {
    ++simulated;
    return diagnosis::MakeMotionStudy({&measured, 1});
  };
  const auto search = [&](const diagnosis::Study&) { return std::vector<NamedClaim>{{name, delta_bic}}; };
  return diagnosis::JudgeBySimulation({&claim, 1}, {}, simulate, search, 1, InTurn).front();
}

TEST(JudgeBySimulation, RefusesWhatRecordsWithoutItShowToo) {
  int simulated = 0;
  const NullEvidence evidence = Judged({"backlash", 50.0}, "backlash", 50.0, simulated);
  EXPECT_TRUE(IsRefused(evidence));
  EXPECT_EQ(simulated, 4) << "no more are needed";
  EXPECT_EQ(evidence.p_value(), 1.0);
}

TEST(JudgeBySimulation, IsSoonClearWhereTheEvidenceIsFarBeyond) {
  int simulated = 0;
  const NullEvidence evidence = Judged({"backlash", 500.0}, "backlash", 50.0, simulated);
  EXPECT_FALSE(IsRefused(evidence));
  EXPECT_EQ(simulated, 4);
  EXPECT_EQ(evidence.strongest, 50.0);
}

TEST(JudgeBySimulation, AsksNineteenRecordsWhereItIsClose) {
  int simulated = 0;
  const NullEvidence evidence = Judged({"backlash", 60.0}, "backlash", 50.0, simulated);
  EXPECT_FALSE(IsRefused(evidence));
  EXPECT_EQ(simulated, 19);
  EXPECT_DOUBLE_EQ(evidence.p_value(), 0.05);
}

TEST(JudgeBySimulation, DoesNotCountAnotherName) {
  int simulated = 0;
  EXPECT_EQ(Judged({"backlash", 60.0}, "time_delay", 500.0, simulated).as_strong, 0);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis_simulated_null_test
