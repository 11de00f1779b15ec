// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/diagnosis_text.h"

#include <gtest/gtest.h>

#include "bench/diagnosis/diagnosis_json.h"
#include "bench/diagnosis/nominal_models.h"
#include "bench/diagnosis/parameter_words.h"
#include "bench/diagnosis/plain_words.h"
#include "bench/diagnosis/trust_report.h"
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
          .starts_with("How sure: diagnose --power measures how large an effect would have been found here.\n"
                       "What to do: nothing: go on with the simulation as it is.\n"
                       "Nothing is missing in the simulation: it explains these records down to their "
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
          .starts_with(
              "What the simulation lacks: an error once per turn (99 % of what the simulation "
              "misses).\n"
              "How sure: chance shows as much in fewer than one of a billion such records; on data that "
              "no fit has seen the\n"
              "error falls by 92 %; but something else would explain these records as well.\n"
              "What to do: measure what tells them apart, as under \"next\".\n"
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
  EXPECT_TRUE(
      text.starts_with("What the simulation lacks: an error once per turn (99 % of what the simulation "
                       "misses, and one smaller\n"
                       "effect).\n"))
      << text;
  EXPECT_LT(text.find("found        output_eccentricity"), text.find("found        backlash")) << text;
  EXPECT_NE(text.find("corrected    the simulation's numbers with what was found:\n"
                      "             offset_arcmin                        0.2500 ± 0.0040 arcmin       "
                      "(without: 0)           where zero lies\n"),
            std::string::npos)
      << text;
}

TEST(PlainWords, SayHowSureAndWhatToDo) {
  MadeUp found = Found();
  found.result.causes[0].indistinguishable_from.clear();
  found.result.causes[0].evidence.p_value = 3e-5;
  found.result.gain.low = -0.1;  // not shown on unseen data
  PlainWords words = PlainWordsOf(found.Report());
  EXPECT_EQ(words.how_sure, "chance shows as much in fewer than one of 10 000 such records");
  EXPECT_EQ(words.what_to_do, "turn the encoder by half a turn");
  found.result.causes[0].evidence.p_value = 0.2;
  EXPECT_EQ(PlainWordsOf(found.Report()).how_sure, "chance may show as much");
  found.result.causes[0].indistinguishable_from = {"backlash", "load_windup"};
  words = PlainWordsOf(found.Report());
  EXPECT_EQ(words.how_sure, "chance may show as much; but 2 other explanations would do as well");
  EXPECT_EQ(words.what_to_do, "measure what tells them apart, as under \"next\"");
}

TEST(PlainWords, OfWhatHasNoNameAskForAnotherMeasurement) {
  const PlainWords words = PlainWordsOf(Unnamed().Report());
  EXPECT_EQ(words.what_is_missing, "");
  EXPECT_EQ(words.how_sure, "chance shows as much in fewer than one of a billion such records");
  EXPECT_EQ(words.what_to_do,
            "measure again as under \"next\": what comes back belongs to the gear or the bench");
}

// Ranges of the angle: held by both, failed by the nominal model in two that touch and one apart, and one of
// few samples.
MadeUp FoundWithRegions() {
  using diagnosis::Validity;
  MadeUp found = Found();
  const auto range = [](double from_deg, double to_deg, double nominal, Validity of_nominal,
                        Validity of_extended) {
    constexpr double kRadPerDeg = 0.017453292519943295;
    return diagnosis::RegressorRange{from_deg * kRadPerDeg,
                                     to_deg * kRadPerDeg,
                                     180,
                                     {nominal / kArcminPerRad, of_nominal},
                                     {0.021 / kArcminPerRad, of_extended}};
  };
  found.result.trusted = {0.02 / kArcminPerRad,
                          {{range(0, 90, 0.02, Validity::kHolds, Validity::kHolds),
                            range(90, 120, 0.3, Validity::kFails, Validity::kHolds),
                            range(120, 180, 0.2, Validity::kFails, Validity::kHolds),
                            range(180, 270, 0.02, Validity::kTooFew, Validity::kTooFew),
                            range(270, 360, 0.1, Validity::kFails, Validity::kHolds)}}};
  return found;
}

TEST(TrustReport, NamesTheRangesInWhichTheSimulationFails) {
  const MadeUp found = FoundWithRegions();
  EXPECT_EQ(
      TrustWords(found.Report(), false),
      "not at output angle 90 to 180 deg (0.3 arcmin), output angle 270 to 360 deg (0.1 arcmin); too few "
      "samples in 1 of 5 ranges");
  EXPECT_EQ(TrustWords(found.Report(), true),
            "everywhere in these records; too few samples in 1 of 5 ranges");
  const std::string text = DiagnosisText(found.Report(), false);
  EXPECT_NE(text.find("\ntrusted      as it is: not at output angle 90 to 180 deg (0.3 arcmin),"),
            std::string::npos)
      << text;
  const auto json = DiagnosisJson(found.Report())["trusted_regions"];
  EXPECT_NEAR(json["noise"].get<double>(), 0.02, 1e-12);
  EXPECT_EQ(json["unit"], "arcmin");
  ASSERT_EQ(json["over"].size(), 1U);
  EXPECT_EQ(json["over"][0]["regressor"], "output_angle");
  const auto& second = json["over"][0]["ranges"][1];
  EXPECT_NEAR(second["low"].get<double>(), 90.0, 1e-9);
  EXPECT_NEAR(second["high"].get<double>(), 120.0, 1e-9);
  EXPECT_EQ(second["samples"], 180);
  EXPECT_NEAR(second["nominal"]["rmse"].get<double>(), 0.3, 1e-12);
  EXPECT_EQ(second["nominal"]["result"], "fails");
  EXPECT_EQ(second["extended"]["result"], "holds");
  EXPECT_EQ(json["over"][0]["ranges"][3]["nominal"]["result"], "too_few_samples");
}

TEST(TrustReport, SaysNowhereAndNothingWhereThatIsSo) {
  MadeUp found = FoundWithRegions();
  for (diagnosis::RegressorRange& range : found.result.trusted.over[0])
    range.nominal.validity = diagnosis::Validity::kFails;
  EXPECT_EQ(TrustWords(found.Report(), false), "nowhere in these records");
  found.result.trusted.over = {{}};
  EXPECT_EQ(TrustWords(found.Report(), false), "these records are too short to say where");
  EXPECT_FALSE(HasTrustedRegions(found.Report()));
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
