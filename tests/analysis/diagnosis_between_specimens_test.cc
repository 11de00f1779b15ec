// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/between_specimens.h"

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/records.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis::diagnosis_between_specimens_test {
namespace {

constexpr double kNoise_arcmin = 0.03;

using ErrorOverTurn = std::function<double(double output_deg)>;

ErrorOverTurn Once(double amplitude_arcmin, double phase_deg) {
  return [=](double output_deg) { return amplitude_arcmin * std::cos(RadFromDeg(output_deg - phase_deg)); };
}
double Nothing(double /*output_deg*/) { return 0.0; }

// A turn each way in steps of 1 deg: the second harmonic of each gear's own, noise, and the error given.
TransmissionErrorData Sweep(unsigned seed, const ErrorOverTurn& error_arcmin) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const double second_arcmin = 0.4 + 0.05 * normal(random);
  const double second_deg = 180.0 * normal(random);
  TransmissionErrorData record;
  for (int i = 0; i < 722; ++i) {
    const double output_deg = i < 361 ? i : 721 - i;
    const double error = second_arcmin * std::cos(RadFromDeg(160.0 * output_deg - second_deg)) +
                         error_arcmin(output_deg) + kNoise_arcmin * normal(random);
    record.input_angle_rad.push_back(80.0 * RadFromDeg(output_deg));
    record.output_angle_rad.push_back(RadFromDeg(output_deg) - RadFromArcmin(error));
    record.direction.push_back(i < 361 ? 1 : -1);
    record.time_s.push_back(2.0 * i);
  }
  return record;
}

std::vector<SpecimenComparison> Compare(const std::vector<ErrorOverTurn>& errors) {
  std::vector<std::unique_ptr<Study>> studies;
  std::vector<Diagnosis> diagnoses;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const TransmissionErrorData record = Sweep(20 + static_cast<unsigned>(i), errors[i]);
    studies.push_back(MakeTransmissionErrorStudy({&record, 1}));
    diagnoses.push_back(Diagnose(*studies.back()));
  }
  std::vector<DiagnosedSpecimen> specimens;
  for (std::size_t i = 0; i < errors.size(); ++i) specimens.push_back({*studies[i], diagnoses[i]});
  return CompareSpecimens(specimens, {.phases = true});
}

TEST(BetweenSpecimens, AnEccentricityOfTheBenchIsShared) {
  const auto compared = Compare({Once(0.3, 40.0), Once(0.3, 40.0), Once(0.3, 40.0), Once(0.3, 40.0)});
  ASSERT_EQ(compared.size(), 1U);
  const SpecimenComparison& cause = compared.front();
  EXPECT_EQ(cause.name, "output_eccentricity");
  EXPECT_EQ(cause.belonging, Belonging::kShared);
  EXPECT_TRUE(cause.phases);
  EXPECT_EQ(cause.present(), 4U);
  // The mean of four with errors of noise · √(2/722) each, along either axis; 4 standard errors.
  const double error = kNoise_arcmin * std::sqrt(2.0 / 722.0) / 2.0;
  EXPECT_NEAR(cause.effects->mean(0), 0.3 * std::cos(RadFromDeg(40.0)), 4.0 * error);
  EXPECT_NEAR(cause.effects->mean(1), 0.3 * std::sin(RadFromDeg(40.0)), 4.0 * error);
  EXPECT_LT(cause.effects->tau_high, 0.03);
  EXPECT_FALSE(cause.specimens_needed);
}

TEST(BetweenSpecimens, EccentricitiesOfTheirOwnAreOwn) {
  const auto compared = Compare({Once(0.3, 40.0), Once(0.15, 170.0), Once(0.4, 250.0), Once(0.2, -30.0)});
  ASSERT_EQ(compared.size(), 1U);
  EXPECT_EQ(compared.front().name, "output_eccentricity");
  EXPECT_EQ(compared.front().present(), 4U);
  EXPECT_EQ(compared.front().belonging, Belonging::kOwn);
  EXPECT_GT(compared.front().effects->tau_low, 0.05);
}

// Amplitudes alone would be called shared.
TEST(BetweenSpecimens, OneAmplitudeAtPhasesOfTheirOwnIsOwn) {
  const auto compared = Compare({Once(0.3, 0.0), Once(0.3, 90.0), Once(0.3, 180.0), Once(0.3, 270.0)});
  ASSERT_EQ(compared.size(), 1U);
  EXPECT_EQ(compared.front().belonging, Belonging::kOwn);
}

TEST(BetweenSpecimens, ADamagedToothIsOfTheOneThatHasIt) {
  const auto tooth = [](double output_deg) {
    const double off = std::remainder(output_deg - 120.0, 360.0) / 2.0;
    return 0.35 * std::exp(-0.5 * off * off);
  };
  const auto compared = Compare({Nothing, Nothing, tooth, Nothing, Nothing});
  ASSERT_EQ(compared.size(), 1U);
  const SpecimenComparison& cause = compared.front();
  EXPECT_EQ(cause.name, "local_tooth_damage");
  EXPECT_FALSE(cause.phases);
  EXPECT_EQ(cause.belonging, Belonging::kOwn);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(cause.sizes[i].found, i == 2) << i;
    EXPECT_EQ(cause.sizes[i].amount && cause.sizes[i].present(), i == 2) << i;
  }
}

TEST(BetweenSpecimens, WithoutACauseHaveNothingToCompare) {
  EXPECT_TRUE(Compare({Nothing, Nothing, Nothing}).empty());
}

// Two that are a quarter apart: neither is shown, and one more would do.
TEST(BetweenSpecimens, TwoAreTooFewAndItIsSaidHowManyWouldDo) {
  const auto compared = Compare({Once(0.34, 40.0), Once(0.26, 40.0)});
  ASSERT_EQ(compared.size(), 1U);
  const SpecimenComparison& cause = compared.front();
  EXPECT_EQ(cause.belonging, Belonging::kUndecided);
  ASSERT_TRUE(cause.specimens_needed);
  // τ of 0.04: its bound is 0.04 · √(2/0.0506) = 0.25 of two, 0.04 · √(4/0.484) = 0.115 of three, by the 2.5
  // % quantiles of χ² with 2 and 4 degrees of freedom; half of the mean is 0.15.
  EXPECT_EQ(*cause.specimens_needed, 3);
}

// What one specimen has faintly, below what its own diagnosis names, counts as there.
TEST(BetweenSpecimens, ASizeThatIsNotNamedIsMeasuredAllTheSame) {
  const auto compared = Compare({Once(0.1, 40.0), Once(0.1, 40.0), Once(0.004, 40.0)});
  ASSERT_EQ(compared.size(), 1U);
  const SpecimenSize& faint = compared.front().sizes[2];
  EXPECT_FALSE(faint.found);
  ASSERT_TRUE(faint.amount);
  EXPECT_NEAR(faint.amount->value, 0.004, 4.0 * faint.amount->standard_error);
}

TEST(VectorOf, HasItsErrorsAlongAndAcross) {
  const statistics::GroupEstimate up =
      VectorOf({"amplitude_arcmin", "arcmin", 2.0, 0.1}, {"phase_deg", "deg", 90.0, DegFromRad(0.2)});
  EXPECT_NEAR(up.value(0), 0.0, 1e-12);
  EXPECT_NEAR(up.value(1), 2.0, 1e-12);
  EXPECT_NEAR(up.covariance(0, 0), 0.4 * 0.4, 1e-12);
  EXPECT_NEAR(up.covariance(1, 1), 0.1 * 0.1, 1e-12);
  EXPECT_NEAR(up.covariance(0, 1), 0.0, 1e-12);
  // A phase that nobody knows: the error of the amplitude stands for both.
  const statistics::GroupEstimate faint =
      VectorOf({"amplitude_arcmin", "arcmin", 0.01, 0.1}, {"phase_deg", "deg", 45.0, 180.0});
  EXPECT_NEAR(faint.covariance(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(faint.covariance(1, 1), 0.01, 1e-12);
}

// A study that answers with the numbers it is given: what the comparison makes of them.
class GivenStudy final : public Study {
 public:
  GivenStudy(std::vector<CauseRule> rules, std::vector<ParameterValue> numbers)
      : rules_(std::move(rules)), numbers_(std::move(numbers)) {}
  std::span<const double> measured() const override { return {}; }
  std::span<const std::size_t> segments() const override { return {}; }
  const std::vector<CauseRule>& causes() const override { return rules_; }
  const std::vector<Regressor>& regressors() const override { return regressors_; }
  std::string unit() const override { return "arcmin"; }
  double unit_per_si() const override { return 1.0; }
  ModelFit Fit(std::span<const std::size_t> causes, std::span<const double>, const ModelFit*,
               FitPurpose purpose) const override {
    EXPECT_EQ(purpose, FitPurpose::kReport);
    ModelFit fit;
    fit.causes.assign(causes.begin(), causes.end());
    fit.cause_parameters.assign(causes.size(), numbers_);
    fit.usable = true;
    return fit;
  }
  double NoiseFloor() const override { return 0.0; }
  std::size_t BlockLength() const override { return 1; }
  std::vector<UserQuantity> Quantities(const Eigen::VectorXd&) const override { return {}; }
  const std::vector<std::string>& warnings() const override { return warnings_; }
  Eigen::VectorXd Predict(std::span<const ParameterValue>, std::span<const NamedCause>) const override {
    return {};
  }

 private:
  std::vector<CauseRule> rules_;
  std::vector<ParameterValue> numbers_;
  std::vector<Regressor> regressors_;
  std::vector<std::string> warnings_;
};

CauseRule Ripple(double trials = 1.0) {
  return {.name = "ripple", .parameters = {{"amplitude_Nm", "Nm", 0.0, 10.0, true}}, .trials_factor = trials};
}

// Phases of different orders do not compare: the amplitude is taken alone.
TEST(BetweenSpecimens, LeaveAPhaseOutThatGoesWithAnOrder) {
  std::vector<GivenStudy> studies;
  for (const double phase_deg : {0.0, 90.0, 180.0}) {
    studies.emplace_back(std::vector<CauseRule>{Ripple()},
                         std::vector<ParameterValue>{{"amplitude_Nm", "Nm", 1.0, 0.01},
                                                     {"phase_deg", "deg", phase_deg, 0.5},
                                                     {"order_per_turn", "1/turn", 7.0 + phase_deg, 0.01}});
  }
  Diagnosis found;
  found.causes.push_back({0, {}, {}, 0.0, {}, {}});
  found.extended.usable = true;
  std::vector<DiagnosedSpecimen> specimens;
  for (const GivenStudy& study : studies) specimens.push_back({study, found});
  const auto compared = CompareSpecimens(specimens, {.phases = true});
  ASSERT_EQ(compared.size(), 1U);
  EXPECT_FALSE(compared.front().phases);
  EXPECT_EQ(compared.front().belonging, Belonging::kShared);
}

// A size that the search picked from a hundred places is not there for being three errors from zero.
TEST(BetweenSpecimens, ChargeForThePlacesThatWereSearched) {
  const std::vector<ParameterValue> three_errors{{"amplitude_Nm", "Nm", 0.03, 0.01}};
  const GivenStudy one(std::vector<CauseRule>{Ripple()}, three_errors);
  const GivenStudy many(std::vector<CauseRule>{Ripple(100.0)}, three_errors);
  const GivenStudy large(std::vector<CauseRule>{Ripple()}, {{"amplitude_Nm", "Nm", 1.0, 0.01}});
  Diagnosis found;
  found.causes.push_back({0, {}, {}, 0.0, {}, {}});
  const Diagnosis nothing;
  const std::vector<DiagnosedSpecimen> specimens{{large, found}, {one, nothing}, {many, nothing}};
  const auto compared = CompareSpecimens(specimens, {});
  ASSERT_EQ(compared.size(), 1U);
  EXPECT_TRUE(compared.front().sizes[1].present());
  EXPECT_FALSE(compared.front().sizes[2].present());
  EXPECT_NEAR(compared.front().sizes[2].zero_p, 0.27, 0.005);
}

// A specimen whose records have no such column, and one that leaves the size open, are not compared.
TEST(BetweenSpecimens, LeaveOutWhatIsNotKnown) {
  const GivenStudy knows(std::vector<CauseRule>{Ripple()}, {{"amplitude_Nm", "Nm", 1.0, 0.01}});
  const GivenStudy open(std::vector<CauseRule>{Ripple()}, {{"amplitude_Nm", "Nm", 1.0, INFINITY}});
  const GivenStudy without(std::vector<CauseRule>{}, {});
  Diagnosis found;
  found.causes.push_back({0, {}, {}, 0.0, {}, {}});
  const Diagnosis nothing;
  const std::vector<DiagnosedSpecimen> specimens{{knows, found}, {open, nothing}, {without, nothing}};
  const auto compared = CompareSpecimens(specimens, {});
  ASSERT_EQ(compared.size(), 1U);
  EXPECT_EQ(compared.front().known(), 1U);
  EXPECT_FALSE(compared.front().effects);
  EXPECT_EQ(compared.front().belonging, Belonging::kUndecided);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_between_specimens_test
