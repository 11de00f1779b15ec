// SPDX-License-Identifier: Apache-2.0
// What is said of several specimens; the numbers are made up.
#include "bench/diagnosis/specimens_report.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/bench/made_up_diagnosis.h"

namespace strainwave::bench::specimens_report_test {
namespace {

using diagnosis::Belonging;
using diagnosis::SpecimenComparison;
using diagnosis::SpecimenSize;

SpecimenSize Size(double value, bool found) {
  return {.found = found,
          .amount = ParameterValue{"amplitude_arcmin", "arcmin", value, 0.01},
          .phase = ParameterValue{"phase_deg", "deg", 0.0, 2.0},
          .zero_p = found ? 1e-9 : 0.4};
}

SpecimenSize Unknown() { return {.found = true, .amount = {}, .phase = {}}; }

class Specimens : public testing::Test {
 protected:
  Specimens() {
    for (const char* const name : {"A", "B", "C"})
      report_.specimens.push_back({name, name, made_up_.Report()});
    comparison_.name = "output_eccentricity";
    comparison_.phases = true;
    comparison_.sizes = {Size(0.31, true), Size(0.29, true), Size(0.3, true)};
    auto& effects = comparison_.effects.emplace();
    effects.mean = Eigen::Vector2d(0.0, 0.3);
    effects.mean_covariance = Eigen::Matrix2d::Identity() * 0.0004;
    effects.mean_p = 1e-5;
    effects.tau = 0.02;
    effects.tau_high = 0.1;
    effects.degrees_of_freedom = 4;
    effects.homogeneity_p = 0.25;
  }
  std::string Sentence() const { return BelongingSentence(report_, comparison_); }

  MadeUp made_up_ = Found();
  SpecimensReport report_;
  SpecimenComparison comparison_;
};

TEST_F(Specimens, SayWhyAnEffectIsTheBenchs) {
  comparison_.belonging = Belonging::kShared;
  EXPECT_EQ(
      Sentence(),
      "comes with the bench: all 3 specimens have it, and they differ by at most 0.1 arcmin (95 %) where "
      "the mean is 0.3 arcmin");
}

TEST_F(Specimens, SayWhoseAnEffectIs) {
  comparison_.belonging = Belonging::kOwn;
  comparison_.effects->tau_low = 0.01;
  EXPECT_EQ(
      Sentence(),
      "belongs to the units: all 3 specimens have it, each in its own size or phase; they differ by 0.01 "
      "to 0.1 arcmin (95 %) where the mean is 0.3 arcmin");
  comparison_.sizes[1] = Size(0.01, false);
  EXPECT_EQ(Sentence(),
            "belongs to the units: A, C have it, B does not; they differ by 0.01 to 0.1 arcmin (95 %)");
  comparison_.sizes[2] = Size(0.01, false);
  EXPECT_EQ(Sentence(),
            "belongs to the units: A has it, B, C do not; they differ by 0.01 to 0.1 arcmin (95 %)");
}

TEST_F(Specimens, SayHowManyMoreWouldDecide) {
  EXPECT_EQ(
      Sentence(),
      "undecided: 3 of 3 specimens have it; they may differ by 0 to 0.1 arcmin (95 %) where the mean is "
      "0.3 arcmin; more specimens like these would not decide it");
  comparison_.specimens_needed = 5;
  EXPECT_TRUE(Sentence().ends_with("; about 5 specimens like these would decide it")) << Sentence();
  comparison_.sizes = {Size(0.31, true), Unknown(), Unknown()};
  comparison_.effects.reset();
  EXPECT_EQ(Sentence(), "undecided: its size is known of 1 of 3 specimens");
}

TEST_F(Specimens, AreATableForPeople) {
  comparison_.belonging = Belonging::kShared;
  comparison_.sizes[2] = Unknown();
  report_.comparisons = {comparison_};
  EXPECT_EQ(
      SpecimensText(report_),
      R"(3 specimens, records of kind transmission_error: 1 shared (with the bench), 0 own (to the units), 0 undecided.

A            One effect is missing in the simulation: output_eccentricity or backlash (bench or unit).
B            One effect is missing in the simulation: output_eccentricity or backlash (bench or unit).
C            One effect is missing in the simulation: output_eccentricity or backlash (bench or unit).

output_eccentricity: shared (amplitude_arcmin)
             comes with the bench: all 2 specimens have it, and they differ by at most 0.1 arcmin (95 %) where
             the mean is 0.3 arcmin
             A                          0.310 ± 0.010 arcmin         at 0.0 ± 2.0 deg         found
             B                          0.290 ± 0.010 arcmin         at 0.0 ± 2.0 deg         found
             C                          –                                                     found
             mean                       0.300 ± 0.020 arcmin         at 90.0 deg              p 1e-05
             between specimens          0.02 arcmin                  (95 %: 0 to 0.1)         all alike: p 0.250

An effect of the bench that changes with each mounting, as the phase of an encoder that was set again, looks
like the units' own; what every unit has by design, as the engagement of teeth, looks like the bench's.
)");
}

TEST_F(Specimens, AreADocumentForPrograms) {  // docs/contract.md#several-specimens
  comparison_.sizes[2] = Unknown();
  report_.comparisons = {comparison_};
  const auto json = SpecimensJson(report_);
  EXPECT_EQ(json["kind"], "transmission_error");
  EXPECT_EQ(json["specimens"][1]["specimen"], "B");
  EXPECT_EQ(json["specimens"][1]["diagnosis"]["verdict"], "effect_found");
  const auto& cause = json["shared"][0];
  EXPECT_EQ(cause["verdict"], "undecided");
  EXPECT_EQ(
      cause["specimens"][0].dump(),
      R"({"specimen":"A","found":true,"present":true,"value":0.31,"se":0.01,"phase_deg":0.0,"phase_se_deg":2.0,"zero_p":1e-09})");
  EXPECT_EQ(
      cause["specimens"][2].dump(),
      R"({"specimen":"C","found":true,"present":null,"value":null,"se":null,"phase_deg":null,"phase_se_deg":null,"zero_p":null})");
  EXPECT_EQ(cause["mean"].dump(), R"({"value":0.3,"se":0.02,"phase_deg":90.0,"p_value":1e-05})");
  EXPECT_EQ(cause["between"].dump(), R"({"sd":0.02,"low":0.0,"high":0.1,"sd_of_moments":0.0})");
  EXPECT_EQ(cause["homogeneity"].dump(), R"({"q":0.0,"degrees_of_freedom":4,"p_value":0.25})");
  EXPECT_TRUE(cause["specimens_needed"].is_null());
}

TEST(PhasesHaveOneZero, OnlyWhereAnEncoderGivesIt) {
  EXPECT_TRUE(PhasesHaveOneZero(StudyKind::kTransmissionError));
  EXPECT_FALSE(PhasesHaveOneZero(StudyKind::kVibration));
}

}  // namespace
}  // namespace strainwave::bench::specimens_report_test
