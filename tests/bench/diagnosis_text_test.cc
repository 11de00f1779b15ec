// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/diagnosis_text.h"

#include <gtest/gtest.h>

#include "bench/diagnosis/diagnosis_json.h"
#include "bench/diagnosis/nominal_models.h"
#include "bench/diagnosis/parameter_words.h"
#include "tests/bench/made_up_diagnosis.h"

namespace strainwave::bench::diagnosis_text_test {
namespace {

TEST(DiagnosisText, OpensWithTheVerdict) {
  MadeUp nothing;
  EXPECT_EQ(
      VerdictSentence(nothing.Report()),
      "Nothing was found missing in the simulation, but it does not explain these records down to their "
      "noise: its error on unseen data is 14 times that (too few data, or noise that is not white).");
  nothing.result.nominal_heldout_rmse = 1.02 * nothing.result.noise_floor;
  EXPECT_TRUE(
      DiagnosisText(nothing.Report(), false)
          .starts_with("Nothing is missing in the simulation: it explains these records down to their "
                       "noise.\n"));
  MadeUp stated = Unnamed();
  stated.result.verdict = diagnosis::Verdict::kNoEffect;
  EXPECT_TRUE(
      VerdictSentence(stated.Report())
          .starts_with("Nothing is missing in the simulation, but a number of the record is wrong: "));
  EXPECT_NE(DiagnosisText(stated.Report(), false).find("\nnext         put what stands under \"to correct\""),
            std::string::npos);
  EXPECT_TRUE(
      DiagnosisText(Found().Report(), false)
          .starts_with("What the simulation lacks: an error once per turn (99 % of what it misses).\n"
                       "One effect is missing in the simulation: output_eccentricity or backlash (bench "
                       "or unit).\n"));
  EXPECT_EQ(
      VerdictSentence(Unnamed().Report()),
      "Something is missing in the simulation that no known cause explains: line over output angle: order "
      "7.00 per output turn, amplitude 0.213 arcmin, phase 12 deg.");
}

TEST(DiagnosisText, ShowsEvidenceGainAndTheNextMeasurement) {
  const std::string text = DiagnosisText(Found().Report(), false);
  for (const char* part :
       {"amplitude_arcmin                     0.4000 ± 0.0020 arcmin", "   (before: 0.1)",
        "yes output_eccentricity", " no backlash", "not away from zero",
        "0.28 -> 0.021 arcmin, 92 % less (91 to 94 % with 95 %\n             confidence); noise 0.02 arcmin",
        "             - kind: transmission_error\n", "e_max_arcmin", "sha256 aaaaaaaaaaaa"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nin\n" << text;
  }
}

TEST(DiagnosisText, HasTheCorrectedNumbersAndTheLargestCauseFirst) {
  MadeUp found = Found();
  found.result.extended.nominal = {{"offset_arcmin", "arcmin", 0.25, 0.004}};
  found.result.causes.insert(found.result.causes.begin(), {1, {}, {900.0, 0.0, 400.0}, 0.01, {}});
  const std::string text = DiagnosisText(found.Report(), false);
  EXPECT_TRUE(text.starts_with(
      "What the simulation lacks: an error once per turn (99 % of what it misses, and one smaller "
      "effect).\n"))
      << text;
  EXPECT_LT(text.find("found        output_eccentricity"), text.find("found        backlash")) << text;
  EXPECT_NE(text.find("corrected    the simulation's numbers with what was found:\n"
                      "             offset_arcmin                        0.2500 ± 0.0040 arcmin       "
                      "(without: 0)           where zero lies\n"),
            std::string::npos)
      << text;
}

TEST(DiagnosisText, TellsWhatSimulatedRecordsShowOfACause) {
  MadeUp found = Found();
  EXPECT_EQ(DiagnosisText(found.Report(), false).find("simulated without it"), std::string::npos);
  found.result.causes[0].simulated = {19, 1, 700.0};
  EXPECT_NE(DiagnosisText(found.Report(), false)
                .find("             of 19 records simulated without it, 1 show as much\n"),
            std::string::npos);
  EXPECT_EQ(DiagnosisJson(found.Report())["causes"][0]["simulated_without_it"].dump(),
            R"({"records":19,"as_strong":1,"strongest_delta_bic":700.0,"p_value":0.1})");
}

TEST(DiagnosisText, KeepsLongListsForWhoAsksForThem) {
  MadeUp found = Found();
  found.result.causes[0].parameters.push_back({"cosine_1_accel_x_m_per_s2", "m/s^2", 0.5, 0.1});
  const std::string brief = DiagnosisText(found.Report(), false);
  EXPECT_EQ(brief.find("cosine_1"), std::string::npos) << brief;
  EXPECT_NE(brief.find("and 1 numbers of its lines and channels (--details)"), std::string::npos) << brief;
  EXPECT_NE(DiagnosisText(found.Report(), true).find("cosine_1_accel_x_m_per_s2"), std::string::npos);
}

TEST(ParameterWords, AreThereForEveryNumberOfTheDataSheets) {
  for (const StudyKind kind :
       {StudyKind::kTransmissionError, StudyKind::kHysteresis, StudyKind::kMotion, StudyKind::kVibration}) {
    for (const ParameterValue& parameter : NominalParameters(kind)) {
      EXPECT_NE(ParameterWords(parameter.name), "") << parameter.name;
    }
  }
  EXPECT_EQ(ParameterWords("k1_Nm_per_rad"), "stiffness up to T1");
  EXPECT_EQ(ParameterWords("k1_Nm_per_rad_per_K"), "change with the temperature");
  EXPECT_EQ(ParameterWords("second_friction_torque_Nm"), "of the second friction element");
  EXPECT_EQ(ParameterWords("no_such_number"), "");
}

}  // namespace
}  // namespace strainwave::bench::diagnosis_text_test
