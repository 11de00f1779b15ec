// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/joint_records.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "bench/errors/bench_error.h"
#include "bench/fingerprint/fingerprint_data.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::joint_records_test {
namespace {

// One joint that swings, with its acceleration or without.
std::string Swinging(int rows, double rate_hz, bool acceleration) {
  std::string text = fmt::format("# kind: joints\ntime_s,q1_rad,qd1_rad_per_s,tau1_Nm{}\n",
                                 acceleration ? ",qdd1_rad_per_s2" : "");
  for (int i = 0; i < rows; ++i) {
    const double t = i / rate_hz;
    text += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g}", t, std::sin(t), std::cos(t), 2.0 * std::sin(t));
    text += acceleration ? fmt::format(",{:.9g}\n", -std::sin(t)) : "\n";
  }
  return text;
}

class JointRecords : public testing::Test {
 protected:
  JointFile Read(const std::string& text, const Smoothing& smoothing = {},
                 Acceleration acceleration = Acceleration::kAsThere) const {
    daq::WriteBytes(folder_ / "a.csv", text);
    return ReadJointFile(folder_ / "a.csv", smoothing, acceleration);
  }
  std::string MessageOf(const std::string& text, const Smoothing& smoothing = {}) const {
    try {
      Read(text, smoothing);
    } catch (const BenchError& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::kWrongInput);
      return std::string(error.what()).substr(folder_.path().string().size() + 1);
    }
    return "";
  }
  daq::ScratchFolder folder_;
};

TEST_F(JointRecords, AreSmoothedAndTheAccelerationIsTheSlopeOfTheVelocity) {
  for (const bool measured : {false, true}) {
    const JointFile file = Read(Swinging(2000, 250.0, measured));
    EXPECT_EQ(file.acceleration_measured, measured);
    EXPECT_NEAR(file.sample_rate_hz, 250.0, 1e-6);
    EXPECT_EQ(file.window, 13);  // the odd one nearest to 0.051 s
    ASSERT_EQ(file.motion.states.cols(), 3);
    for (const Eigen::Index row : {0, 1, 1000, 1999}) {
      const double t = static_cast<double>(row) / 250.0;
      EXPECT_NEAR(file.motion.states(row, 0), std::sin(t), 1e-5);
      EXPECT_NEAR(file.motion.states(row, 1), std::cos(t), 1e-5);
      EXPECT_NEAR(file.motion.states(row, 2), -std::sin(t), 2e-3);
      EXPECT_NEAR(file.motion.torques_Nm(row, 0), 2.0 * std::sin(t), 1e-5);
    }
  }
  EXPECT_FALSE(Read(Swinging(2000, 250.0, true), {}, Acceleration::kDerived).acceleration_measured);
}

TEST_F(JointRecords, TellTheLowPassThatTheFilterIs) {
  EXPECT_NEAR(Read(Swinging(2000, 1000.0, false), {0.501, 3, true}).half_power_hz, 2.1, 0.05);
}

TEST_F(JointRecords, RefuseEvenWindowsAndRecordsShorterThanTwo) {
  EXPECT_EQ(
      MessageOf(Swinging(2000, 1000.0, false), {0.5, 3, true}),
      "a.csv: error: a window of 0.5 s is 500 samples at 1000 Hz (expected an odd number, so that it has a "
      "middle, for instance 0.501 s)");
  EXPECT_EQ(MessageOf(Swinging(892, 1000.0, false), {0.501, 3, true}),
            "a.csv: error: 892 samples, less than two windows of 501 (0.501 s at 1000 Hz) (expected 1002 or "
            "more, or a "
            "shorter --window)");
  EXPECT_EQ(MessageOf(Swinging(50, 10.0, false), {0.3, 3, true}),
            "a.csv: error: a window of 0.3 s is 3 samples at 10 Hz (expected 5 or more for a polynomial of "
            "order 3)");
  EXPECT_EQ(MessageOf("# kind: motion\n# inertia_kgm2: 1\ntime_s,position_rad,torque_Nm\n0,1,2\n0.1,1,2\n"),
            "a.csv: error: is a record of kind motion (expected kind: joints)");
}

TEST_F(JointRecords, OfASlowLoggerTakeTheShortestWindowAndSaySo) {
  const JointFile file = Read(Swinging(100, 10.0, false));
  EXPECT_EQ(file.window, 5);
  EXPECT_EQ(file.warnings,
            std::vector<std::string>{"at 10 Hz a window of 0.051 s has 1 samples; 5 were taken"});
}

TEST(HealthyClass, IsToldByItsNameOrIsTheOneOfMostFiles) {
  std::string warning;
  EXPECT_EQ(HealthyClassOf({"Fault A", "NORMAL", "Fault A"}, warning), "NORMAL");
  EXPECT_EQ(HealthyClassOf({"brake", "healthy_unit"}, warning), "healthy_unit");
  EXPECT_EQ(warning, "");
  EXPECT_EQ(HealthyClassOf({"a", "b", "b"}, warning), "b");
  EXPECT_EQ(
      warning,
      "no class has a name such as healthy or normal; 'b', which most files have, is taken for it (--healthy "
      "NAME says which is)");
}

}  // namespace
}  // namespace strainwave::bench::joint_records_test
