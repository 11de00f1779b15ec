// SPDX-License-Identifier: Apache-2.0
// What is said of how large an effect has to be; the numbers are made up.
#include "bench/diagnosis/power_report.h"

#include <gtest/gtest.h>

#include <limits>

#include "bench/diagnosis/diagnosis_json.h"
#include "tests/bench/made_up_diagnosis.h"

namespace strainwave::bench::power_report_test {
namespace {

// Of an eccentricity the size is known, backlash is never found.
DiagnosisReport WithPower(const MadeUp& made_up) {
  DiagnosisReport report = made_up.Report();
  diagnosis::DetectionPower power;
  power.causes.push_back({0,
                          "amplitude_arcmin",
                          "arcmin",
                          diagnosis::DetectedFrom{0.91, 0.8, 1.1},
                          diagnosis::DetectedFrom{6.1, 5.2, std::numeric_limits<double>::infinity()},
                          "",
                          {{0.5, 3.0, false, {"backlash"}}, {1.0, 6.0, true, {}}}});
  power.causes.push_back(
      {1, "backlash_arcmin", "arcmin", {}, {}, "not away from zero", {{20.0, 240.0, false, {}}}});
  power.without.resize(20);
  power.without[3].others = {"thermal_drift"};
  power.searches = 23;
  report.power = std::move(power);
  return report;
}

TEST(PowerText, BeginsWithPlainWordsAndSaysWhatIsNeverFound) {
  const MadeUp made_up;
  EXPECT_EQ(PowerText(made_up.Report(), "1 s"), "");
  EXPECT_EQ(PowerText(WithPower(made_up), "41 s"),
            R"(
power        what would have been found here nine times of ten (23 records with planted effects searched in 41 s):
             - an error once per turn: amplitude 0.91 arcmin or more

             found nine times of ten from                              (95 %)                          sigma (95 %)             found  other names
             output_eccentricity                                  0.91 0.8 to 1.1 arcmin                 6.1 5.2 and up        1 of 2  1 backlash
             backlash: never so often, 0 of 1 found up to backlash 20 arcmin (not away from zero)
             not shown by these records at any size: wave_generator_first_harmonic, wave_generator_fourth_harmonic, circular_spline_ovality, thermal_drift, local_tooth_damage, load_windup
             without a planted effect: 1 of 20 records got a name that they do not have: 1 thermal_drift
)");
}

TEST(PowerText, SaysWhyNothingWasMeasured) {
  const MadeUp made_up;
  DiagnosisReport report = made_up.Report();
  report.power.emplace();
  report.power->refusal = "nothing can be planted into records of this kind";
  EXPECT_EQ(PowerText(report, "0 s"),
            "\npower        not measured: nothing can be planted into records of this kind\n");
  EXPECT_EQ(DiagnosisJson(report)["power"].dump(),
            R"({"probability":0.9,"refusal":"nothing can be planted into records of this kind"})");
}

TEST(PowerJson, HasEverySizeAndTrial) {  // docs/contract.md#diagnose
  const MadeUp made_up;
  EXPECT_FALSE(DiagnosisJson(made_up.Report()).contains("power"));
  const auto json = DiagnosisJson(WithPower(made_up))["power"];
  EXPECT_EQ(json["probability"], 0.9);
  EXPECT_EQ(json["records_searched"], 23);
  EXPECT_EQ(
      json["causes"][0].dump(),
      R"({"name":"output_eccentricity","parameter":"amplitude_arcmin","unit":"arcmin","size":{"value":0.91,"low":0.8,"high":1.1},)"
      R"("sigma":{"value":6.1,"low":5.2,"high":null},"objection":"","found":1,"with_other_names":1,"other_names":{"backlash":1},)"
      R"("trials":[{"size":0.5,"sigma":3.0,"found":false,"other_names":["backlash"]},{"size":1.0,"sigma":6.0,"found":true,"other_names":[]}]})");
  EXPECT_TRUE(json["causes"][1]["size"].is_null());
  EXPECT_EQ(json["causes"][1]["objection"], "not away from zero");
  EXPECT_EQ(json["not_shown"].size(), 6u);
  EXPECT_EQ(json["without_effect"].dump(),
            R"({"records":20,"with_other_names":1,"other_names":{"thermal_drift":1}})");
}

}  // namespace
}  // namespace strainwave::bench::power_report_test
