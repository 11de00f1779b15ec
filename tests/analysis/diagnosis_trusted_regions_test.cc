// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/trusted_regions.h"

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/records.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis::diagnosis_trusted_regions_test {
namespace {

// A record that answers what it is made of; nothing is fitted.
class Record final : public Study {
 public:
  explicit Record(std::vector<Regressor> regressors)
      : measured_(regressors.front().values.size(), 0.0), regressors_(std::move(regressors)) {}
  std::span<const double> measured() const override { return measured_; }
  std::span<const std::size_t> segments() const override { return segments_; }
  const std::vector<CauseRule>& causes() const override { return rules_; }
  const std::vector<Regressor>& regressors() const override { return regressors_; }
  std::string unit() const override { return "arcmin"; }
  double unit_per_si() const override { return 1.0; }
  ModelFit Fit(std::span<const std::size_t>, std::span<const double>, const ModelFit*,
               FitPurpose) const override {
    return {};
  }
  double NoiseFloor() const override { return 0.0; }
  std::size_t BlockLength() const override { return 10; }
  std::vector<UserQuantity> Quantities(const Eigen::VectorXd&) const override { return {}; }
  const std::vector<std::string>& warnings() const override { return warnings_; }
  Eigen::VectorXd Predict(std::span<const ParameterValue>, std::span<const NamedCause>) const override {
    return {};
  }

 private:
  std::vector<double> measured_;
  std::vector<std::size_t> segments_{0};
  std::vector<CauseRule> rules_;
  std::vector<Regressor> regressors_;
  std::vector<std::string> warnings_;
};

// An angle that goes through five turns, a torque that swings, and a speed of three values.
Record FiveTurns(std::size_t samples) {
  std::vector<double> angle(samples), torque(samples), speed(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(samples);
    angle[i] = 5.0 * kTwoPi * share;
    torque[i] = 30.0 * std::sin(17.0 * share);
    speed[i] = std::floor(3.0 * share);
  }
  return Record({{"angle", "angle / deg", DegFromRad(1.0), angle, true},
                 {"torque", "torque / Nm", 1.0, torque, false},
                 {"speed", "speed / rpm", 1.0, speed, false}});
}

// Autoregressive of the first order, of unit variance; its innovations normal, or of heavy tails (Student's t
// of five degrees of freedom).
std::vector<double> Noise(std::size_t samples, unsigned seed, double correlation = 0.0, bool heavy = false) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::student_t_distribution<double> student(5.0);
  std::vector<double> noise(samples);
  double last = normal(random);
  for (double& value : noise) {
    const double innovation = heavy ? student(random) * std::sqrt(3.0 / 5.0) : normal(random);
    last = correlation * last + std::sqrt(1.0 - correlation * correlation) * innovation;
    value = last;
  }
  return noise;
}

std::vector<double> WithMisfit(const Record& record, std::vector<double> noise,
                               const std::function<double(double angle, double torque)>& misfit) {
  for (std::size_t i = 0; i < noise.size(); ++i)
    noise[i] += misfit(record.regressors()[0].values[i], record.regressors()[1].values[i]);
  return noise;
}

TEST(TrustedRegions, AreThoseWithoutTheMisfit) {
  const Record record = FiveTurns(12000);
  const std::vector<double> noise = Noise(12000, 1);
  // At 75 to 105 degrees of each turn a bump as high as two standard deviations.
  const std::vector<double> nominal = WithMisfit(record, noise, [](double angle, double) {
    const double within = std::fmod(angle, kTwoPi);
    return within > RadFromDeg(75.0) && within < RadFromDeg(105.0) ? 2.0 : 0.0;
  });
  const std::vector<double> weights(noise.size(), 1.0);
  const TrustedRegions regions = FindTrustedRegions(record, weights, noise, {nominal, noise});
  EXPECT_NEAR(regions.noise, 1.0, 0.03);
  ASSERT_EQ(regions.over.size(), 3U);
  ASSERT_EQ(regions.over[0].size(), 24U);
  for (std::size_t sector = 0; sector < 24; ++sector) {
    const RegressorRange& range = regions.over[0][sector];
    EXPECT_NEAR(range.low, static_cast<double>(sector) * kTwoPi / 24.0, 1e-12);
    EXPECT_EQ(range.samples, 500U);
    const bool hit = sector == 5 || sector == 6;
    EXPECT_EQ(range.nominal.validity, hit ? Validity::kFails : Validity::kHolds) << sector;
    EXPECT_EQ(range.extended.validity, Validity::kHolds) << sector;
    EXPECT_NEAR(range.nominal.rmse, hit ? std::sqrt(5.0) : 1.0, 0.15) << sector;
  }
}

TEST(TrustedRegions, TakeEachOfFewValuesForItself) {
  const Record record = FiveTurns(3000);
  const std::vector<double> noise = Noise(3000, 2);
  const std::vector<double> weights(noise.size(), 1.0);
  const TrustedRegions regions = FindTrustedRegions(record, weights, noise, {noise, noise});
  ASSERT_EQ(regions.over[2].size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(regions.over[2][k].low, static_cast<double>(k));
    EXPECT_EQ(regions.over[2][k].high, static_cast<double>(k));
    EXPECT_EQ(regions.over[2][k].samples, 1000U);
  }
}

TEST(TrustedRegions, SeeAMisfitOverTheTorqueAlone) {
  const Record record = FiveTurns(6000);
  const std::vector<double> noise = Noise(6000, 3);
  const std::vector<double> nominal = WithMisfit(
      record, noise, [](double, double torque) { return torque > 20.0 ? 0.4 * (torque - 20.0) : 0.0; });
  const std::vector<double> weights(noise.size(), 1.0);
  const TrustedRegions regions = FindTrustedRegions(record, weights, noise, {nominal, noise});
  for (const RegressorRange& range : regions.over[1]) {
    if (range.high > 20.0 && range.low < 24.0) continue;
    EXPECT_EQ(range.nominal.validity, range.low >= 24.0 ? Validity::kFails : Validity::kHolds) << range.low;
  }
}

TEST(TrustedRegions, AreSeldomClaimedFromFewSamples) {
  const Record record = FiveTurns(60);
  const std::vector<double> weights(60, 1.0);
  int too_few = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    const std::vector<double> noise = Noise(60, 300 + seed);
    const TrustedRegions regions = FindTrustedRegions(record, weights, noise, {noise, noise});
    ASSERT_EQ(regions.over[0].size(), 6U);
    for (const RegressorRange& range : regions.over[0]) {
      EXPECT_EQ(range.samples, 10U);
      too_few += range.nominal.validity == Validity::kTooFew ? 1 : 0;
    }
  }
  // The upper bound of ten samples is below 1.3 where their mean square is at most 0.67: one of four.
  EXPECT_GE(too_few, 50 * 6 * 2 / 3);
}

TEST(TrustedRegions, LeaveOutWhatHasNoWeight) {
  const Record record = FiveTurns(3000);
  std::vector<double> noise = Noise(3000, 5);
  std::vector<double> weights(noise.size(), 1.0);
  for (std::size_t i = 0; i < noise.size(); i += 30) {
    noise[i] = 1000.0;
    weights[i] = 0.0;
  }
  const TrustedRegions regions = FindTrustedRegions(record, weights, noise, {noise, noise});
  EXPECT_NEAR(regions.noise, 1.0, 0.06);
  std::size_t samples = 0;
  for (const RegressorRange& range : regions.over[0]) {
    EXPECT_EQ(range.nominal.validity, Validity::kHolds);
    samples += range.samples;
  }
  EXPECT_EQ(samples, 2900U);
}

// Records of a model that misses nothing in which a range of any regressor fails, of 300: at most
// kTrustFamilyError of them, that is 3; more than 10 come by chance in fewer than one of a thousand such
// tests.
void ExpectFewFalseFailures(double correlation, bool heavy) {
  const Record record = FiveTurns(2400);
  const std::vector<double> weights(2400, 1.0);
  int failing = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const std::vector<double> noise = Noise(2400, 100 + seed, correlation, heavy);
    bool fails = false;
    const TrustedRegions regions = FindTrustedRegions(record, weights, noise, {noise, noise});
    for (const auto& ranges : regions.over)
      for (const RegressorRange& range : ranges) fails = fails || range.nominal.validity == Validity::kFails;
    failing += fails ? 1 : 0;
  }
  EXPECT_LE(failing, 10);
}

TEST(TrustedRegions, SeldomFailWithoutAMisfit) { ExpectFewFalseFailures(0.0, false); }
TEST(TrustedRegions, SeldomFailWithoutAMisfitInNoiseThatIsNotWhite) { ExpectFewFalseFailures(0.8, false); }
TEST(TrustedRegions, SeldomFailWithoutAMisfitInNoiseOfHeavyTails) { ExpectFewFalseFailures(0.0, true); }

TEST(TrustedRegions, SeldomHoldWhereTheMisfitIsAsLargeAsTheNoise) {
  const Record record = FiveTurns(2400);
  const std::vector<double> weights(2400, 1.0);
  int holding = 0;
  int ranges = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const std::vector<double> noise = Noise(2400, 700 + seed);
    const std::vector<double> nominal = WithMisfit(
        record, noise, [](double angle, double) { return std::sqrt(2.0) * std::sin(7.0 * angle); });
    const TrustedRegions regions = FindTrustedRegions(record, weights, noise, {nominal, noise});
    for (const RegressorRange& range : regions.over[0]) {
      ++ranges;
      holding += range.nominal.validity == Validity::kHolds ? 1 : 0;
    }
  }
  EXPECT_EQ(ranges, 40 * 24);
  EXPECT_LE(holding, ranges / 20);
}

TEST(TrustedRegions, AskForOneValueASample) {
  const Record record = FiveTurns(100);
  const std::vector<double> noise = Noise(100, 6);
  const std::vector<double> weights(99, 1.0);
  try {
    FindTrustedRegions(record, weights, noise, {noise, noise});
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "weights has 99 values, measured has 100 (expected the same number)");
  }
}

// A sweep of one turn each way with a damaged tooth: its own noise and its own way of drawing angles.
TEST(TrustedRegions, OfADiagnosisLeaveStructureWithoutANameInTheExtendedModel) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  TransmissionErrorData record;
  for (int i = 0; i < 1440; ++i) {
    const double along_rad = RadFromDeg(0.5 * (i < 720 ? i : 1439 - i));
    const double error_arcmin = 0.5 * std::cos(160.0 * along_rad - 0.8) + 0.3 * std::cos(along_rad) +
                                0.25 * std::cos(11.0 * along_rad) + 0.05 * normal(random);
    record.input_angle_rad.push_back(80.0 * along_rad);
    record.output_angle_rad.push_back(along_rad - RadFromArcmin(error_arcmin));
    record.direction.push_back(i < 720 ? 1 : -1);
    record.time_s.push_back(2.0 * i);
  }
  const auto study = MakeTransmissionErrorStudy({&record, 1});
  const Diagnosis diagnosis = Diagnose(*study);
  ASSERT_EQ(diagnosis.verdict, Verdict::kEffectFound);
  ASSERT_FALSE(diagnosis.nuisance_terms.empty());
  const std::vector<RegressorRange>& angle = diagnosis.trusted.over.front();
  ASSERT_GE(angle.size(), 6U);
  for (const RegressorRange& range : angle) {
    EXPECT_EQ(range.extended.validity, Validity::kFails) << range.low;
    // The amplitude without a name over √2, and the noise.
    EXPECT_NEAR(range.extended.rmse, RadFromArcmin(std::hypot(0.25 / std::sqrt(2.0), 0.05)),
                RadFromArcmin(0.07));
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_trusted_regions_test
