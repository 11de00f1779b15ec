// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/law_departure.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/records.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis::diagnosis_law_departure_test {
namespace {

constexpr double kNoise_arcmin = 0.02;

struct Place {
  double output_rad;
  double share;  // of the record
  double torque_Nm;
};
using Effect = std::function<double(const Place&)>;  // arcmin

// One turn each way.
TransmissionErrorData Sweep(unsigned seed, const Effect& effect) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  TransmissionErrorData record;
  for (int i = 0; i < 720; ++i) {
    const double along_rad = RadFromDeg(i < 360 ? i : 719 - i);
    const double time_s = 2.0 * i;
    const Place place{along_rad, i / 720.0, 5.0 * std::sin(0.013 * time_s) + 0.5 * normal(random)};
    const double error_arcmin =
        0.5 * std::cos(160.0 * along_rad - 0.8) + effect(place) + kNoise_arcmin * normal(random);
    record.input_angle_rad.push_back(80.0 * along_rad);
    record.output_angle_rad.push_back(along_rad - RadFromArcmin(error_arcmin));
    record.direction.push_back(i < 360 ? 1 : -1);
    record.time_s.push_back(time_s);
    record.torque_Nm.push_back(place.torque_Nm);
  }
  return record;
}

// Laws that are not quite our formulae.
double WindupThatGrows(const Place& at) { return 0.05 * at.torque_Nm * (1.0 + 0.2 * at.share); }
double EccentricityThatGrows(const Place& at) {
  return 0.3 * std::cos(at.output_rad) * (1.0 + 0.2 * at.share);
}

std::vector<std::string> NamesIn(const TransmissionErrorData& record) {
  const auto study = MakeTransmissionErrorStudy({&record, 1});
  std::vector<std::string> names;
  for (const auto& cause : Diagnose(*study).causes) names.push_back(study->causes()[cause.index].name);
  return names;
}

TEST(LawDeparture, GivesNoSecondNameToWhatTheFirstOnesFormulaMisses) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    EXPECT_EQ(NamesIn(Sweep(seed, WindupThatGrows)), std::vector<std::string>{"load_windup"}) << seed;
    EXPECT_EQ(NamesIn(Sweep(seed, EccentricityThatGrows)), std::vector<std::string>{"output_eccentricity"})
        << seed;
  }
}

TEST(LawDeparture, LeavesASecondCauseItsName) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::vector<std::string> names = NamesIn(Sweep(seed, [](const Place& at) {
      return WindupThatGrows(at) + 0.03 * std::cos(2.0 * at.output_rad + 0.4);
    }));
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()),
              (std::set<std::string>{"circular_spline_ovality", "load_windup"}))
        << seed;
  }
}

// By hand: of a wind-up that grows by a fifth over the record, beside its mean, a tenth of it at either end:
// over time, 0.1/√3 of it in root mean square, about.
TEST(LawDeparture, IsFoundOverTheRegressorThatItFollows) {
  const TransmissionErrorData record = Sweep(9, WindupThatGrows);
  const auto study = MakeTransmissionErrorStudy({&record, 1});
  const auto rule = std::ranges::find(study->causes(), "load_windup", &CauseRule::name);
  const std::vector<std::size_t> causes{static_cast<std::size_t>(rule - study->causes().begin())};
  ASSERT_NE(rule, study->causes().end());
  const std::vector<double> weights(study->measured().size(), 1.0);
  const ModelFit fit = study->Fit(causes, weights, nullptr, FitPurpose::kJudge);
  const auto departure = LargestLawDeparture(*study, weights, fit, causes.front(), 0.4);
  ASSERT_TRUE(departure.has_value());
  EXPECT_EQ(departure->over, "time");
  EXPECT_NEAR(departure->relative_size, 0.1 / std::sqrt(3.0), 0.02);
  EXPECT_FALSE(LargestLawDeparture(*study, weights, fit, causes.front(), 0.0).has_value());
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_law_departure_test
