// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/motion/samples.h"
#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_stops_test {
namespace {

// A move or a dwell of a commanded speed profile.
struct Move {
  double speed_m_per_s{};
  double ramp_s{};
  double cruise_s{};
  double dwell_s{};
};

// Speed at a time of a move.
double SpeedAt(const Move& move, double time_s) {
  const double end_s = 2.0 * move.ramp_s + move.cruise_s;
  const double share = std::min(time_s, end_s - time_s) / move.ramp_s;
  return move.speed_m_per_s * std::clamp(share, 0.0, 1.0);
}

std::vector<Move> DrawMoves(std::mt19937& random, double slowest_m_per_s) {
  std::uniform_real_distribution<double> unit;
  std::vector<Move> moves;
  double place_m = 0.0;
  for (int i = 0; i < 24; ++i) {
    Move move{0.1 + 0.4 * unit(random), 0.25, 0.1 + 0.3 * unit(random), 0.05 + 0.6 * unit(random)};
    if (i % 5 == 0) move.speed_m_per_s = slowest_m_per_s;
    if (place_m > 0.0) move.speed_m_per_s = -move.speed_m_per_s;
    place_m += move.speed_m_per_s * (move.ramp_s + move.cruise_s);
    moves.push_back(move);
  }
  return moves;
}

// A linear axis under position control that sticks where it stops: the force wanders between the two values
// of its dry friction while it stands, at times for less than a tenth of a second. Nothing is missing in its
// model.
MotionData SticksWhereItStops(unsigned seed) {
  constexpr double kStep_s = 2.5e-4, kLog_s = 2e-3, kMass_kg = 93.0, kViscous_Ns_per_m = 19.0,
                   kCoulomb_N = 120.0;
  constexpr double kBandwidth_rad_per_s = 25.0, kNoise_N = 3.3, kEncoder_m = 1e-6;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MotionData record;
  record.linear = true;
  double place_m = 0.0, speed_m_per_s = 0.0, wanted_m = 0.0, time_s = 0.0, logged_s = 0.0;
  for (const Move& move : DrawMoves(random, 0.05)) {
    const double end_s = 2.0 * move.ramp_s + move.cruise_s + move.dwell_s;
    for (double since_s = 0.0; since_s < end_s; since_s += kStep_s, time_s += kStep_s) {
      const double wanted_m_per_s = SpeedAt(move, since_s);
      wanted_m += kStep_s * wanted_m_per_s;
      const double forward_N = kMass_kg / kStep_s * (SpeedAt(move, since_s + kStep_s) - wanted_m_per_s) +
                               kCoulomb_N * std::tanh(wanted_m_per_s / 0.005);
      const double force_N = forward_N + kMass_kg * kBandwidth_rad_per_s *
                                             (kBandwidth_rad_per_s * (wanted_m - place_m) +
                                              1.8 * (wanted_m_per_s - speed_m_per_s));
      if (time_s >= logged_s) {
        logged_s += kLog_s;
        record.time_s.push_back(time_s);
        record.position.push_back(kEncoder_m * std::round(place_m / kEncoder_m));
        record.torque.push_back(force_N + kNoise_N * normal(random));
      }
      const double free = speed_m_per_s + kStep_s * (force_N - kViscous_Ns_per_m * speed_m_per_s) / kMass_kg;
      const double held = kStep_s * kCoulomb_N / kMass_kg;
      speed_m_per_s = free - std::clamp(free, -held, held);
      place_m += kStep_s * speed_m_per_s;
    }
  }
  return record;
}

TEST(MotionStops, ShowNothingThatIsMissing) {
  for (const unsigned seed : {1U, 2U}) {
    const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {SticksWhereItStops(seed)});
    EXPECT_EQ(found.names(), Names{}) << seed;
  }
}

// What bridges the top of an acceleration transient, which looks like a spike, is not the torque that acted.
TEST(MotionStops, NothingIsTakenFromWhatBridgesASpike) {
  constexpr std::size_t kSpike = 500;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  MotionData record;
  for (int i = 0; i < 1000; ++i) {
    record.time_s.push_back(1e-3 * i);
    record.position.push_back(std::sin(20e-3 * i));
    record.torque.push_back(-0.4 * std::sin(20e-3 * i) + 0.01 * normal(random));
  }
  record.torque[kSpike] += 1.0;
  const MotionSamples samples = PrepareMotion({&record, 1});
  const std::vector<bool>& unknown = samples.segments.front().clipped;
  EXPECT_TRUE(unknown[kSpike]);
  EXPECT_LE(std::ranges::count(unknown, true), 3);
}

// Of an axis that stands for most of a record, and moves by many steps of its encoder in each sample.
TEST(MotionStops, HideNoNoiseOfTheEncoder) {
  constexpr double kStep_rad = 1e-5;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  MotionData record;
  double place = 0.0;
  for (int i = 0; i < 6000; ++i) {
    const int since = i % 1000;
    const double speed =
        std::clamp(0.1 * std::min(since, 350 - since), 0.0, 1.0) * (1.0 + 0.1 * std::sin(0.02 * i));
    place += 1e-3 * speed * (i / 1000 % 2 == 0 ? 1.0 : -1.0);
    record.time_s.push_back(1e-3 * i);
    record.position.push_back(kStep_rad * std::round(place / kStep_rad));
    record.torque.push_back(0.1 * speed + 0.01 * normal(random));
  }
  const MotionSamples samples = PrepareMotion({&record, 1});
  EXPECT_NEAR(samples.position_noise, kStep_rad / std::sqrt(12.0), 0.1 * kStep_rad);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_stops_test
