// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/diagnosis/hysteresis/gear.h"
#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/diagnosed_loop.h"
#include "tests/analysis/generated_loop.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::diagnosis::diagnosis_hysteresis_test {
namespace {

// Three loops with holds at their ends.
std::vector<PathLeg> Loops(double peak_Nm = 34.0, double hold_s = 10.0) {
  std::vector<PathLeg> path;
  for (int loop = 0; loop < 3; ++loop) {
    path.push_back({.to_Nm = peak_Nm, .rate_Nm_per_s = 1.0, .hold_s = hold_s});
    path.push_back({.to_Nm = -peak_Nm, .rate_Nm_per_s = 1.0, .hold_s = hold_s});
  }
  path.push_back({.to_Nm = 0.0, .rate_Nm_per_s = 1.0});
  return path;
}

Diagnosed Ask(const GeneratedGear& gear, const GeneratedSensors& sensors = {}, std::uint32_t seed = 5,
              const std::vector<PathLeg>& path = Loops()) {
  return DiagnoseLoop(gear, sensors, path, 4000, seed);
}

void ExpectNear(const ParameterValue& parameter, double truth, double most_relative_error) {
  EXPECT_NEAR(parameter.value, truth, 4.0 * parameter.standard_error + 0.02 * std::abs(truth))
      << parameter.name;
  EXPECT_LT(parameter.standard_error, most_relative_error * std::abs(truth)) << parameter.name;
}

// Two minutes of hold at each end of a stiff friction's loop: torque that goes to and fro by its noise would
// wind it up, and the record be blamed for it.
TEST(HysteresisStudy, FindsNothingInLongHoldsOfANoisyTorque) {
  for (const std::uint32_t seed : {1U, 2U, 3U, 4U}) {
    const Diagnosed clean =
        Ask({.friction_Nm = {3.0}, .yield_rad = {0.7e-4}},
            {.torque_noise_Nm = 0.02, .angle_noise_rad = RadFromArcmin(0.004)}, seed, Loops(34.0, 30.0));
    EXPECT_EQ(clean.names(), Names()) << seed;
    EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect) << seed;
  }
}

// The noise of a torque on a soft gear, most of which was smoothed away: over fifty samples its mean varies
// as that of white noise does.
TEST(HysteresisStudy, LeavesTheTorquesNoiseWhite) {
  const Diagnosed clean =
      Ask({.k1_Nm_per_rad = 6.7e3, .k2_Nm_per_rad = 1.1e4, .k3_Nm_per_rad = 1.35e4},
          {.torque_noise_Nm = 0.02, .angle_noise_rad = RadFromArcmin(0.003)}, 8, Loops(34.0, 0.0));
  EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect);
  constexpr std::size_t kTogether = 50;
  double square_sum = 0.0;
  double square_sum_of_means = 0.0;
  double means = 0.0;
  const std::span<const double> measured = clean.study->measured();
  for (std::size_t first = 0; first + kTogether <= measured.size(); first += kTogether) {
    double sum = 0.0;
    for (std::size_t i = first; i < first + kTogether; ++i) {
      const double left = measured[i] - clean.diagnosis.nominal.predicted(static_cast<Eigen::Index>(i));
      square_sum += left * left;
      sum += left;
    }
    square_sum_of_means += sum * sum;
    ++means;
  }
  // Three standard deviations of a variance of 80 means.
  EXPECT_NEAR(square_sum_of_means / square_sum, 1.0, 3.0 * std::sqrt(2.0 / means));
}

// Autoregressive noise moves the measured angle, and a line over that angle moves with it.
TEST(HysteresisStudy, FindsNoLineOverTheAngleInAutoregressiveNoise) {
  const std::vector<PathLeg> path{{34.0, 1.0}, {-34.0, 1.0}, {0.0, 1.0}};
  for (const std::uint32_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    const Diagnosed clean = Ask(
        {.k1_Nm_per_rad = 2.4e4,
         .k2_Nm_per_rad = 3.6e4,
         .k3_Nm_per_rad = 4.2e4,
         .friction_Nm = {0.5},
         .yield_rad = {1.1e-4}},
        {.torque_noise_Nm = 0.0, .angle_noise_rad = RadFromArcmin(0.03), .autoregression = 0.7}, seed, path);
    EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect) << seed;
  }
}

// With as many points on the way as it takes for no step to hold more than one kink, and with few.
TEST(FillTwist, DoesNotHangOnHowFineTheWayIs) {
  GearLaw law{};
  law.spring = {
      .k1_Nm_per_rad = 1.5e4, .k2_Nm_per_rad = 2.4e4, .k3_Nm_per_rad = 3e4, .t1_Nm = 7.0, .t2_Nm = 25.0};
  law.friction_elements = 3;
  law.friction[0] = {1.2, 1e-4};
  law.friction[1] = {0.4, 4e-5};
  law.friction[2] = {0.3, 9e-4};
  law.start_share = {{0.5, -1.0, 0.0}};
  law.asymmetry_share = {0.1, -0.05, 0.2};
  law.backlash = {2e-5, 0.4};
  law.backlash_beside_friction = true;
  const auto path = [](int parts) {
    LoopGrid grid;
    double from_Nm = 0.0;
    for (const double to_Nm : {30.0, 28.0, 31.0, -33.0, -33.0, 2.0, -1.5, 34.0, 0.0}) {
      for (int part = 1; part <= parts; ++part) {
        grid.time_s.push_back(static_cast<double>(grid.time_s.size()) / parts);
        grid.torque_Nm.push_back(from_Nm + (to_Nm - from_Nm) * part / parts);
      }
      from_Nm = to_Nm;
    }
    grid.turn_Nm.assign(grid.time_s.size(), std::nan(""));
    grid.turn_share.assign(grid.time_s.size(), 0.0);
    grid.rate_Nm_per_s.assign(grid.time_s.size(), 0.0);
    grid.starts = {0, grid.time_s.size()};
    return grid;
  };
  for (const double hardening : {0.0, 3e8}) {
    law.hardening_Nm_per_rad3 = hardening;
    constexpr int kParts = 400;
    LoopGrid coarse = path(1);
    LoopGrid fine = path(kParts);
    // Both start at the same torque.
    for (LoopGrid* grid : {&coarse, &fine}) {
      grid->time_s.insert(grid->time_s.begin(), -1.0);
      grid->torque_Nm.insert(grid->torque_Nm.begin(), 0.0);
      grid->turn_Nm.insert(grid->turn_Nm.begin(), std::nan(""));
      grid->turn_share.insert(grid->turn_share.begin(), 0.0);
      grid->rate_Nm_per_s.insert(grid->rate_Nm_per_s.begin(), 0.0);
      ++grid->starts.back();
    }
    Eigen::VectorXd few;
    Eigen::VectorXd many;
    FillTwist(law, coarse, few);
    FillTwist(law, fine, many);
    for (Eigen::Index i = 0; i < few.size(); ++i) EXPECT_NEAR(many(i * kParts), few(i), 1e-13) << i;
  }
}

TEST(HysteresisStudy, FindsNothingInACleanLoopAndFitsItsNumbers) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const Diagnosed clean = Ask({}, {}, seed);
    EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect) << seed;
    EXPECT_EQ(clean.names(), Names()) << seed;
    ExpectNear(clean.nominal("k1_Nm_per_rad"), 1.5e4, 0.01);
    ExpectNear(clean.nominal("k2_Nm_per_rad"), 2.4e4, 0.01);
    ExpectNear(clean.nominal("k3_Nm_per_rad"), 3.0e4, 0.01);
    ExpectNear(clean.nominal("friction_torque_Nm"), 1.2, 0.02);
  }
}

TEST(HysteresisStudy, NamesADeadZone) {
  const Diagnosed found = Ask({.outside_dead_zone_rad = RadFromArcmin(0.15)});
  EXPECT_EQ(found.names(), Names{"backlash"});
  ExpectNear(found.value("backlash_arcmin"), 0.15, 0.1);
}

// Flanks that meet little by little.
TEST(HysteresisStudy, NamesADeadZoneWithRoundedEnds) {
  GeneratedSensors sensors;
  sensors.unlisted_rad = [](double, double torque_Nm, double, bool) {
    return 0.5 * RadFromArcmin(0.4) * std::tanh(torque_Nm / 0.6);
  };
  const Diagnosed found = Ask({}, sensors);
  EXPECT_EQ(found.names(), Names{"backlash"});
  ExpectNear(found.value("backlash_arcmin"), 0.4, 0.1);
  ExpectNear(found.value("dead_zone_torque_Nm"), 0.6, 0.1);
}

TEST(HysteresisStudy, NamesASideThatIsStiffer) {
  const Diagnosed found = Ask({.stiffer_share = 0.01});
  EXPECT_EQ(found.names(), Names{"asymmetric_stiffness"});
  ExpectNear(found.value("asymmetry_share"), 0.01, 0.1);
}

TEST(HysteresisStudy, NamesASpringThatHardens) {
  const Diagnosed found = Ask({.hardening_Nm_per_rad3 = 4e8});
  EXPECT_EQ(found.names(), Names{"cubic_hardening"});
  ExpectNear(found.value("hardening_Nm_per_rad3"), 4e8, 0.1);
}

TEST(HysteresisStudy, NamesCreepUnderHeldTorque) {
  const Diagnosed found = Ask({.creep_share = 0.01, .creep_s = 4.0});
  EXPECT_EQ(found.names(), Names{"creep"});
  ExpectNear(found.value("time_constant_s"), 4.0, 0.35);
}

// A yielding mount follows the torque: nothing of the friction's loop is in it. Strong enough for what a
// creep of the wind-up would leave over to look like another cause.
TEST(HysteresisStudy, NamesOnlyCreepWhereTheMountYields) {
  const Diagnosed found = Ask({.creep_s = 4.0, .creep_rad_per_Nm = 3e-6});
  EXPECT_EQ(found.names(), Names{"creep"});
  ExpectNear(found.value("creep_arcmin_per_Nm"), ArcminFromRad(3e-6), 0.1);
  ExpectNear(found.value("time_constant_s"), 4.0, 0.1);
}

TEST(HysteresisStudy, NamesABrakeThatSlips) {
  const Diagnosed found = Ask({.slip_from_Nm = 28.0, .slip_rad_per_Nms = 2e-7});
  EXPECT_EQ(found.names(), Names{"brake_slip"});
}

TEST(HysteresisStudy, GivesTheSlipTorqueTheErrorOfAllTheWaysInWhichABrakeMaySlip) {
  int inside = 0;
  for (std::uint32_t seed = 5; seed < 13; ++seed) {
    // Whether it is faster the more it is loaded these loops can hardly tell.
    const Diagnosed found = Ask({.slip_from_Nm = 24.0, .slip_rad_per_Nms = 4e-8}, {}, seed);
    EXPECT_EQ(found.names(), Names{"brake_slip"});
    const ParameterValue level = found.value("slip_torque_Nm");
    inside += std::abs(level.value - 24.0) < 1.96 * level.standard_error ? 1 : 0;
  }
  EXPECT_GE(inside, 7);
}

TEST(HysteresisStudy, NamesADriftWithTemperature) {
  GeneratedSensors sensors;
  sensors.has_temperature = true;
  sensors.drift_rad = [](double, double temperature_K) { return RadFromArcmin(0.08) * temperature_K; };
  const Diagnosed found = Ask({}, sensors);
  EXPECT_EQ(found.names(), Names{"thermal_drift"});
  ExpectNear(found.value("drift_arcmin_per_K"), 0.08, 0.1);
}

// A room by day and night, without a temperature in the record.
TEST(HysteresisStudy, NamesADriftThatSwingsBack) {
  GeneratedSensors sensors;
  sensors.drift_rad = [](double time_s, double) {
    return RadFromArcmin(0.1) * std::sin(kTwoPi * time_s / 400.0 + 1.0);
  };
  const Diagnosed found = Ask({}, sensors);
  EXPECT_EQ(found.names(), Names{"thermal_drift"});
  ExpectNear(found.value("drift_swing_arcmin"), 0.1, 0.1);
  ExpectNear(found.value("period_s"), 400.0, 0.1);
}

TEST(HysteresisStudy, NamesATorqueSignalThatIsShifted) {
  const Diagnosed found = Ask({}, {.torque_offset_Nm = 0.4});
  EXPECT_EQ(found.names(), Names{"torque_zero_offset"});
  ExpectNear(found.value("offset_Nm"), 0.4, 0.1);
}

TEST(HysteresisStudy, NamesASpectrumOfFriction) {
  const Diagnosed found = Ask({.friction_Nm = {0.6, 0.6}, .yield_rad = {5e-5, 6e-4}});
  EXPECT_EQ(found.names(), Names{"distributed_friction"});
}

TEST(HysteresisStudy, NamesALoopThatWidensWithTheRate) {
  const std::vector<PathLeg> path{{34.0, 0.5, 0.5},  {-34.0, 0.5, 0.5}, {0.0, 0.5, 0.5},   {34.0, 5.0, 0.5},
                                  {-34.0, 5.0, 0.5}, {34.0, 5.0, 0.5},  {-34.0, 5.0, 0.5}, {0.0, 5.0, 0.5}};
  const Diagnosed found = Ask({.damper_Nms_per_rad = 2500.0}, {}, 6, path);
  EXPECT_EQ(found.names(), Names{"rate_dependence"});
  ExpectNear(found.value("viscous_Nms_per_rad"), 2500.0, 0.1);
}

// Friction that goes with the logarithm of the rate, which a torque held still takes back.
TEST(HysteresisStudy, NamesFrictionThatRisesWithTheRate) {
  std::vector<PathLeg> path;
  for (const double rate : {2.0, 8.0, 1.0, 16.0}) {
    path.push_back({34.0, rate, 0.5});
    path.push_back({-34.0, rate, 0.5});
    path.push_back({0.0, rate, 0.5});
  }
  const Diagnosed found = Ask({.rise_with_rate = 0.1}, {}, 6, path);
  EXPECT_EQ(found.names(), Names{"rate_dependence"});
  EXPECT_GT(found.value("friction_rise_share").value, 0.0);
}

// The angle a fixed time behind the torque's rate, at every torque by as much.
TEST(HysteresisStudy, NamesATwistThatLagsBehindTheRate) {
  const std::vector<PathLeg> path{{34.0, 1.0}, {-34.0, 1.0}, {0.0, 1.0},
                                  {34.0, 8.0}, {-34.0, 8.0}, {0.0, 8.0}};
  GeneratedSensors sensors;
  double before_s = 0.0;
  double before_Nm = 0.0;
  double rate_Nm_per_s = 0.0;
  sensors.unlisted_rad = [&](double time_s, double torque_Nm, double, bool) {
    if (time_s > before_s) rate_Nm_per_s = (torque_Nm - before_Nm) / (time_s - before_s);
    before_s = time_s;
    before_Nm = torque_Nm;
    return -RadFromArcmin(0.003) * rate_Nm_per_s;
  };
  sensors.torque_noise_Nm = 0.0;
  const Diagnosed found = Ask({}, sensors, 7, path);
  EXPECT_EQ(found.names(), Names{"rate_dependence"});
  ExpectNear(found.value("lag_rad_s_per_Nm"), RadFromArcmin(0.003), 0.1);
}

TEST(HysteresisStudy, NamesASlipThatComesAtOnceAndStays) {
  const Diagnosed found = Ask({.slip_from_Nm = 26.3, .slip_at_once_rad = RadFromArcmin(0.15)}, {}, 8);
  EXPECT_EQ(found.names(), Names{"brake_slip"});
  ExpectNear(found.value("slip_arcmin"), 0.15, 0.1);
  ExpectNear(found.value("slip_torque_Nm"), 26.3, 0.1);
}

// None of the levels that are tried anyway is near enough for a fit to find this one.
TEST(HysteresisStudy, NamesASlipAtAnyLevel) {
  const Diagnosed found = Ask({.slip_from_Nm = 22.4, .slip_at_once_rad = RadFromArcmin(0.2)}, {}, 8);
  EXPECT_EQ(found.names(), Names{"brake_slip"});
  ExpectNear(found.value("slip_arcmin"), 0.2, 0.1);
}

TEST(HysteresisStudy, NamesAFirstSegmentThatIsStifferOneWay) {
  const Diagnosed found = Ask({.k1_stiffer_share = 0.05}, {}, 9);
  EXPECT_EQ(found.names(), Names{"asymmetric_stiffness"});
  ExpectNear(found.value("k1_asymmetry_share"), 0.05, 0.1);
}

TEST(HysteresisStudy, NamesASecondSegmentThatIsStifferOneWay) {
  const Diagnosed found = Ask({.k2_stiffer_share = 0.03}, {}, 9);
  EXPECT_EQ(found.names(), Names{"asymmetric_stiffness"});
  ExpectNear(found.value("k2_asymmetry_share"), 0.03, 0.1);
}

TEST(HysteresisStudy, CallsAShapeOfNoCauseUnnamed) {
  GeneratedSensors sensors;
  sensors.unlisted_rad = [](double, double torque_Nm, double, bool) {
    return RadFromArcmin(0.02) * std::sin(torque_Nm / 1.7);
  };
  const Diagnosed found = Ask({}, sensors);
  EXPECT_EQ(found.diagnosis.verdict, Verdict::kUnnamedStructure);
  EXPECT_EQ(found.names(), Names());
}

// A shelf or a dent of the spring on one side: not a side that is stiffer, nor a brake that slips.
TEST(HysteresisStudy, LeavesWhatTheTwistDoesAtOnePlaceWithoutAName) {
  for (const bool shelf : {true, false}) {
    GeneratedSensors sensors;
    sensors.unlisted_rad = [shelf](double, double torque_Nm, double, bool) {
      const double x = (torque_Nm - 16.0) / 1.5;
      return RadFromArcmin(0.04) * (shelf ? 0.5 + 0.5 * std::tanh(3.0 * x) : std::exp(-0.5 * x * x));
    };
    const Diagnosed found = Ask({}, sensors);
    EXPECT_EQ(found.names(), Names()) << shelf;
    EXPECT_EQ(found.diagnosis.verdict, Verdict::kUnnamedStructure) << shelf;
    ASSERT_EQ(found.diagnosis.nuisance_terms.size(), 1u) << shelf;
    const Finding& window = found.diagnosis.nuisance_terms.front();
    EXPECT_EQ(found.study->causes()[window.index].name, "window over torque") << shelf;
    EXPECT_NEAR(window.parameters[0].value, 0.04, 4.0 * window.parameters[0].standard_error) << shelf;
    const double middle_Nm = 0.5 * (window.parameters[1].value + window.parameters[2].value);
    EXPECT_NEAR(middle_Nm, 16.0, 0.5) << shelf;
  }
}

TEST(HysteresisStudy, LeavesAShiftThatLastsAWhileWithoutAName) {
  GeneratedSensors sensors;
  sensors.unlisted_rad = [](double time_s, double, double, bool) {
    return time_s > 150.0 && time_s < 175.0 ? 0.6 * GeneratedSensors().angle_noise_rad : 0.0;
  };
  const Diagnosed found = Ask({}, sensors);
  EXPECT_EQ(found.diagnosis.verdict, Verdict::kUnnamedStructure);
  ASSERT_EQ(found.diagnosis.nuisance_terms.size(), 1u);
  const Finding& window = found.diagnosis.nuisance_terms.front();
  EXPECT_EQ(found.study->causes()[window.index].name, "long window in time");
  EXPECT_NEAR(window.parameters[1].value, 150.0, 4.0) << window.parameters[1].name;
  EXPECT_NEAR(window.parameters[2].value, 175.0, 4.0) << window.parameters[2].name;
}

// An encoder's steps are coarser than its noise: it stands still from most samples to the next.
TEST(HysteresisStudy, CountsTheAnglesStepsAsNoise) {
  constexpr double kStep_arcmin = 0.05;
  HysteresisData record = GenerateLoop({}, {.angle_noise_rad = RadFromArcmin(0.002)}, Loops(), 4000, 5);
  for (double& angle_rad : record.output_angle_rad)
    angle_rad = RadFromArcmin(kStep_arcmin * std::round(ArcminFromRad(angle_rad) / kStep_arcmin));
  const double floor_arcmin = ArcminFromRad(MakeHysteresisStudy({&record, 1})->NoiseFloor());
  EXPECT_NEAR(floor_arcmin, kStep_arcmin / std::sqrt(12.0), 0.1 * kStep_arcmin);
}

TEST(HysteresisStudy, JoinsLoopsThatDoNotShowAnOffsetAlone) {
  const GeneratedSensors sensors{.torque_offset_Nm = 0.065, .angle_noise_rad = RadFromArcmin(0.05)};
  std::vector<HysteresisData> loops;
  for (std::uint32_t seed = 21; seed < 27; ++seed)
    loops.push_back(GenerateLoop({}, sensors, Loops(), 1500, seed));
  EXPECT_EQ(DiagnoseRecords(&MakeHysteresisStudy, std::vector<HysteresisData>{loops[0]}).names(), Names());
  EXPECT_EQ(DiagnoseRecords(&MakeHysteresisStudy, loops).names(), Names{"torque_zero_offset"});
}

TEST(HysteresisStudy, SaysWhatIsWrongWithARecord) {
  const auto message = [](const HysteresisData& record) { return RefusalOf(&MakeHysteresisStudy, record); };
  const HysteresisData good = GenerateLoop({}, {}, Loops(), 1000, 9);
  HysteresisData record = good;
  record.time_s.resize(20), record.torque_Nm.resize(20), record.output_angle_rad.resize(20);
  EXPECT_EQ(message(record), "the record is too short: 20 samples (expected at least 60, of a whole loop)");
  record = good;
  std::fill(record.torque_Nm.begin(), record.torque_Nm.end(), 3.0);
  EXPECT_EQ(message(record), "torque_Nm stays between 3 and 3 Nm (expected it to go beyond t1_Nm = 7)");
  record = good;
  std::fill(record.output_angle_rad.begin(), record.output_angle_rad.end(), 0.1);
  EXPECT_EQ(message(record),
            "output_angle_deg stays within 0 arcmin, which is its noise (expected it to follow the torque)");
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_hysteresis_test
