// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/diagnosis/motion/samples.h"
#include "analysis/diagnosis/motion/spikes.h"
#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_acceleration_transients_test {
namespace {

constexpr double kPeriod_s = 2.3;
constexpr double kInertia_kgm2 = 0.02;
constexpr double kCoulomb_Nm = 0.05;
constexpr double kViscous_Nms_per_rad = 0.02;

struct State {
  double position_rad{}, speed_rad_per_s{}, acceleration_rad_per_s2{};
};

// To and fro at constant speed. Every 2.3 s the axis changes over to another speed, within one to three times
// the shortest ramp: its acceleration rises as a parabola, from a kink at either end.
struct Moves {
  double shortest_ramp_s{};

  State At(double time_s) const {
    State state{.position_rad = time_s, .speed_rad_per_s = 1.0};
    for (int k = 0; k < 20; ++k) {
      const double change = (k % 2 == 0 ? -2.0 : 2.0) + 0.2 * std::sin(1.7 * k);
      const double ramp_s = shortest_ramp_s * (1.0 + 2.0 * std::pow(std::fmod(0.37 * k, 1.0), 2));
      const double since_s = time_s - (kPeriod_s * (k + 1) - ramp_s);
      if (since_s < 0.0) break;
      const double u = std::min(since_s / ramp_s, 1.0);
      state.acceleration_rad_per_s2 += change / ramp_s * 6.0 * u * (1.0 - u);
      state.speed_rad_per_s += change * u * u * (3.0 - 2.0 * u);
      state.position_rad += change * (ramp_s * u * u * u * (1.0 - 0.5 * u) + since_s - u * ramp_s);
    }
    return state;
  }
};

struct Logger {
  double rate_Hz{};
  double duration_s{40.0};
  double noise_Nm{};
  double late_share{};   // of a step, by which a sample comes late at most
  double stamp_error{};  // of a step: what the time stamps are wrong by
  double path_noise_rad{2e-8};
  double delay_s{};  // by which the torque acts later than it is recorded
};

MotionData Record(unsigned seed, const Moves& moves, const Logger& logger, double weight_Nm = 0.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, logger.late_share);
  MotionData record;
  const auto count = static_cast<std::size_t>(logger.duration_s * logger.rate_Hz);
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = (static_cast<double>(i) + uniform(random)) / logger.rate_Hz;
    const State now = moves.At(time_s);
    record.time_s.push_back(time_s + logger.stamp_error / logger.rate_Hz * normal(random));
    record.position.push_back(now.position_rad + logger.path_noise_rad * normal(random));
    const State then = moves.At(time_s + logger.delay_s);
    record.torque.push_back(kInertia_kgm2 * then.acceleration_rad_per_s2 +
                            kViscous_Nms_per_rad * then.speed_rad_per_s +
                            kCoulomb_Nm * std::tanh(then.speed_rad_per_s / 0.002) +
                            weight_Nm * std::cos(then.position_rad) + logger.noise_Nm * normal(random));
  }
  return record;
}

Diagnosed Ask(const MotionData& record) { return DiagnoseRecords(&MakeMotionStudy, {record}); }

// A stamp that is wrong puts the sample elsewhere, by its speed times that.
TEST(MotionAccelerationTransients, StampsAreAsWrongAsThePositionInMotionSays) {
  constexpr double kRate_Hz = 50.0;
  const Moves moves{0.3};
  const auto error_s = [&](const Logger& logger) {
    const MotionData record = Record(3, moves, logger);
    return StampError_s(record.time_s, record.position);
  };
  EXPECT_NEAR(error_s({.rate_Hz = kRate_Hz, .late_share = 0.2, .stamp_error = 0.002}), 0.002 / kRate_Hz,
              0.0004 / kRate_Hz);
  EXPECT_LT(error_s({.rate_Hz = kRate_Hz, .late_share = 0.2}), 0.0002 / kRate_Hz);
}

TEST(MotionAccelerationTransients, StampsThatAreWrongMakeNoPlay) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Diagnosed clean = Ask(Record(
        seed, {0.2},
        {.rate_Hz = 50.0, .duration_s = 17.0, .noise_Nm = 0.001, .late_share = 0.25, .stamp_error = 0.002}));
    EXPECT_EQ(clean.names(), Names()) << seed;
  }
}

// Ramps of four samples and more: what they leave between the samples is nobody's effect.
TEST(MotionAccelerationTransients, AreNotTakenForASwingNorForPlay) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Diagnosed clean = Ask(Record(seed, {0.07}, {.rate_Hz = 50.0, .noise_Nm = 0.02}));
    EXPECT_EQ(clean.names(), Names()) << seed;
    EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect) << seed;
  }
}

// Picks and places: moves of different lengths with one acceleration and short stops, whose corners come as
// often as the smoothing is wide. What is usual in the acceleration is then the corners', not its noise.
TEST(MotionAccelerationTransients, ThatComeEveryFewSamplesAreNoPlay) {
  constexpr double kAcceleration = 2100.0;
  constexpr double kLoad_kgm2 = 4.7e-5;
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> length(6.0, 28.0);
    MotionData record;
    double begun_s = 0.05;
    double from_rad = 0.0;
    double way_rad = length(random);
    for (int i = 0; i < 1340; ++i) {
      const double time_s = i / 200.0;
      // A tenth of a second up, as long down, and what is left between.
      const double most_speed = 0.1 * kAcceleration;
      const double ramp_s = std::min(0.1, std::sqrt(std::abs(way_rad) / kAcceleration));
      const double top_speed = std::min(most_speed, kAcceleration * ramp_s);
      const double steady_s = std::abs(way_rad) / top_speed - ramp_s;
      const double end_s = begun_s + 2.0 * ramp_s + steady_s;
      if (time_s > end_s + 0.05) {  // the next move, and this sample again
        from_rad += way_rad;
        begun_s = end_s + 0.05;
        way_rad = (from_rad > 0.0 ? -1.0 : 1.0) * length(random);
        --i;
        continue;
      }
      const double sign = way_rad > 0.0 ? 1.0 : -1.0;
      const double up_s = std::clamp(time_s - begun_s, 0.0, ramp_s);
      const double down_s = std::clamp(time_s - begun_s - ramp_s - steady_s, 0.0, ramp_s);
      const double straight_s = std::clamp(time_s - begun_s - ramp_s, 0.0, steady_s + ramp_s);
      const double speed = sign * kAcceleration * (up_s - down_s);
      const double position =
          from_rad + sign * (kAcceleration * 0.5 * (up_s * up_s - down_s * down_s) + top_speed * straight_s);
      const bool accelerates = up_s > 0.0 && up_s < ramp_s;
      const bool brakes = down_s > 0.0 && down_s < ramp_s;
      const double acceleration = sign * kAcceleration * ((accelerates ? 1.0 : 0.0) - (brakes ? 1.0 : 0.0));
      record.time_s.push_back(time_s);
      record.position.push_back(1e-5 * std::round(1e5 * position));
      record.velocity.push_back(speed + 0.05 * normal(random));
      record.torque.push_back(kLoad_kgm2 * acceleration + 1.3e-4 * speed +
                              0.04 * (speed == 0.0 ? 0.0 : std::copysign(1.0, speed)) - 0.014 +
                              0.0033 * normal(random));
    }
    EXPECT_EQ(Ask(record).names(), Names()) << seed;
  }
}

// Where stamps jitter the path has to be smoothed beyond what the torque follows.
TEST(MotionAccelerationTransients, AreNotTakenForThatWhereTimeStampsJitter) {
  const Logger logger{.rate_Hz = 200.0, .noise_Nm = 0.01, .late_share = 0.3, .stamp_error = 0.002};
  for (const unsigned seed : {4U, 5U, 6U}) {
    const Diagnosed clean = Ask(Record(seed, {0.1}, logger));
    EXPECT_EQ(clean.names(), Names()) << seed;
    EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect) << seed;
  }
}

// Where the path's noise is no longer small beside what is left of the motion, it passes for acceleration
// that the torque does not follow.
TEST(MotionAccelerationTransients, DoNotLetNoiseOfThePathThroughAtAHighRate) {
  const auto logger = [](double rate_Hz, double noise_Nm) {
    return Logger{.rate_Hz = rate_Hz,
                  .duration_s = 20.0,
                  .noise_Nm = noise_Nm,
                  .late_share = 0.35,
                  .stamp_error = 0.002};
  };
  EXPECT_EQ(Ask(Record(5, {0.1}, logger(1000.0, 0.01))).names(), Names());
  EXPECT_EQ(Ask(Record(5, {0.03}, logger(1000.0, 0.03))).names(), Names());
  EXPECT_EQ(Ask(Record(4, {0.03}, logger(2000.0, 0.03))).names(), Names());
}

// The torque turns back within a few samples at the top of each acceleration transient, as at a spike.
TEST(MotionAccelerationTransients, AreNotTakenForSpikesBesideSpikes) {
  for (const unsigned seed : {9U, 10U, 11U}) {
    MotionData record = Record(seed, {0.06}, {.rate_Hz = 200.0, .noise_Nm = 0.01});
    for (std::size_t i = 130; i < record.torque.size(); i += 333)
      record.torque[i] += i % 2 == 0 ? 0.25 : -0.25;
    const Diagnosed clean = Ask(record);
    EXPECT_EQ(clean.names(), Names()) << seed;
    EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect) << seed;
    // "24 samples of the torque stand off …"; the tops of 18 acceleration transients would be twice as many.
    ASSERT_FALSE(clean.study->warnings().empty());
    EXPECT_NEAR(std::stod(clean.study->warnings().front()), 24.0, 3.0) << clean.study->warnings().front();
  }
}

// By its noise such a velocity bends in many a place as a spike of the torque does.
TEST(MotionAccelerationTransients, AreNotMadeOfTheNoiseOfAVelocity) {
  std::mt19937 random(13);
  std::normal_distribution<double> normal;
  MotionData record;
  for (int i = 0; i < 4000; ++i) {
    const double time_s = 0.002 * i;
    const double omega = kTwoPi * 0.4;
    record.time_s.push_back(time_s);
    record.position.push_back(std::sin(omega * time_s));
    record.velocity.push_back(omega * std::cos(omega * time_s) + 0.01 * normal(random));
    record.torque.push_back(-0.07 * omega * omega * std::sin(omega * time_s) + 0.025 * normal(random));
  }
  std::size_t spikes = 0;
  for (std::size_t i = 20; i + 20 < record.torque.size(); i += 41) {
    record.torque[i] += i % 2 == 0 ? 0.4 : -0.4;
    ++spikes;
  }
  EXPECT_EQ(BridgeSpikes(record, 0.0, {}).size(), spikes);
}

// Noise of the path hides what is fast about a ramp, and not when it came.
TEST(MotionAccelerationTransients, TellHowLateATorqueIs) {
  const Logger logger{.rate_Hz = 200.0, .noise_Nm = 0.002, .path_noise_rad = 1e-5, .delay_s = 0.0003};
  for (const unsigned seed : {21U, 22U, 23U}) {
    const Diagnosed found = Ask(Record(seed, {0.1}, logger));
    ASSERT_EQ(found.names(), Names{"time_delay"}) << seed;
    const ParameterValue delay = found.value("delay_s");
    EXPECT_NEAR(delay.value, logger.delay_s, 4.0 * delay.standard_error) << seed;
  }
}

TEST(MotionAccelerationTransients, LeaveTheRestOfTheRecordItsPower) {
  const Diagnosed found = Ask(Record(7, {0.07}, {.rate_Hz = 50.0, .noise_Nm = 0.02}, 0.01));
  EXPECT_EQ(found.names(), Names{"gravity_load"});
  const ParameterValue amplitude = found.value("amplitude_Nm");
  EXPECT_NEAR(amplitude.value, 0.01, 4.0 * amplitude.standard_error);
}

TEST(MotionAccelerationTransients, CostTheRowsAroundThemTheirWeight) {
  const auto study =
      MakeMotionStudy(std::vector<MotionData>{Record(8, {0.07}, {.rate_Hz = 50.0, .noise_Nm = 0.02})});
  const std::span<const double> weights = study->Weights();
  ASSERT_EQ(weights.size(), study->measured().size());
  const auto& regressors = study->regressors();
  const auto time = std::ranges::find(regressors, "time", &Regressor::name);
  ASSERT_NE(time, regressors.end());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double since_s = std::fmod(time->values[i], kPeriod_s);
    if (since_s > 0.5 && since_s < 1.8) {
      EXPECT_EQ(weights[i], 1.0) << time->values[i];
    }
    // The shortest ramp, which ends with the first period.
    if (std::abs(time->values[i] - 2.265) < 0.03) {
      EXPECT_LT(weights[i], 0.2) << time->values[i];
    }
  }
}

// The end of a ramp at speed, where noise of the stamps hides what a kink has above the smoothing.
TEST(MotionAccelerationTransients, CostWeightAlsoWhereNoiseHidesThem) {
  const Logger logger{.rate_Hz = 200.0, .noise_Nm = 0.01, .late_share = 0.3, .stamp_error = 0.002};
  const auto study = MakeMotionStudy(std::vector<MotionData>{Record(4, {0.1}, logger)});
  const auto& regressors = study->regressors();
  const auto time = std::ranges::find(regressors, "time", &Regressor::name);
  ASSERT_NE(time, regressors.end());
  int ends = 0;
  int weighted = 0;
  for (int k = 1; k <= 17; ++k) {
    double least = 1.0;
    for (std::size_t i = 0; i < study->Weights().size(); ++i) {
      if (std::abs(time->values[i] - kPeriod_s * k) < 0.01) least = std::min(least, study->Weights()[i]);
    }
    ++ends;
    if (least < 0.9) ++weighted;
  }
  EXPECT_GE(weighted, ends - 4) << weighted << " of " << ends;
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_acceleration_transients_test
