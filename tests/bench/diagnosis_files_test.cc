// SPDX-License-Identifier: Apache-2.0
// What a diagnosis writes: JSON and the extended model. The diagnosis itself is made up here.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "analysis/diagnosis/records.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/diagnosis/diagnosis_json.h"
#include "bench/diagnosis/diagnosis_pictures.h"
#include "bench/diagnosis/extended_model.h"
#include "bench/diagnosis/nominal_models.h"
#include "tests/bench/made_up_diagnosis.h"
#include "tests/daq/scratch_folder.h"
#include "tests/schedules/schedule_text.h"

namespace strainwave::bench::diagnosis_files_test {
namespace {

TEST(DiagnosisJson, HasEveryFieldOfTheContract) {  // docs/contract.md#diagnose
  const MadeUp made_up = Found();
  const auto json = nlohmann::json::parse(DiagnosisJson(made_up.Report()).dump());
  EXPECT_EQ(json["verdict"], "effect_found");
  EXPECT_EQ(json["kind"], "transmission_error");
  EXPECT_EQ(json["nominal"]["parameters"]["offset_arcmin"]["before"], 0.1);
  EXPECT_NEAR(json["nominal"]["heldout_rmse"].get<double>(), 0.28, 1e-12);
  EXPECT_EQ(json["nominal"]["unit"], "arcmin");
  ASSERT_EQ(json["causes"].size(), 1u);
  const auto& cause = json["causes"][0];
  EXPECT_EQ(cause["name"], "output_eccentricity");
  EXPECT_EQ(cause["where"], "undecided");
  EXPECT_EQ(cause["parameters"]["amplitude_arcmin"],
            (nlohmann::json{{"value", 0.4}, {"se", 0.002}, {"unit", "arcmin"}}));
  EXPECT_EQ(cause["evidence"]["delta_bic"], 812.5);
  EXPECT_EQ(cause["indistinguishable_from"], nlohmann::json::array({"backlash"}));
  EXPECT_NEAR(json["extended"]["heldout_rmse"].get<double>(), 0.021, 1e-12);
  EXPECT_NEAR(json["extended"]["noise_floor"].get<double>(), 0.02, 1e-12);
  EXPECT_EQ(json["gain"]["heldout_rmse_reduction"], 0.925);
  EXPECT_EQ(json["gain"]["ci95"], nlohmann::json::array({0.91, 0.94}));
  EXPECT_EQ(json["unexplained"]["share_of_residual_variance"], 0.01);
  EXPECT_EQ(json["unexplained"]["signature"], "");
  ASSERT_EQ(json["to_settle"].size(), 1u);
  EXPECT_TRUE(json["to_settle"][0].is_string());
  EXPECT_EQ(json["warnings"].size(), 1u);
  EXPECT_TRUE(json["software"].get<std::string>().starts_with("strainwave ")) << json["software"];
  EXPECT_EQ(cause["what_to_do"], "turn the encoder by half a turn");
  EXPECT_EQ(json["plain_words"]["what_is_missing"],
            "an error once per turn (99 % of what the simulation misses)");
  EXPECT_TRUE(json["trusted_regions"]["over"].empty());
  EXPECT_NEAR(json["quantities"]["e_max_arcmin"]["extended"].get<double>(), 0.8, 1e-9);
}

TEST(DiagnosisJson, KnowsNoProbabilityOfZeroAndNoNaN) {
  const MadeUp made_up = Found();
  const std::string text = DiagnosisJson(made_up.Report()).dump();
  const auto json = nlohmann::json::parse(text);
  EXPECT_GT(json["causes"][0]["evidence"]["p_value"].get<double>(), 0.0);
  EXPECT_TRUE(json["causes"][0]["parameters"]["phase_deg"]["se"].is_null());
  EXPECT_TRUE(json["candidates"][1]["evidence"]["heldout_log_likelihood_gain"].is_number());
  EXPECT_EQ(text.find("nan"), std::string::npos);
}

TEST(DiagnosisJson, TellsWhatHasNoNameByItsNumbers) {
  const MadeUp made_up = Unnamed();
  const auto json = nlohmann::json::parse(DiagnosisJson(made_up.Report()).dump());
  EXPECT_EQ(json["verdict"], "unnamed_structure");
  EXPECT_TRUE(json["causes"].empty());
  EXPECT_EQ(json["unexplained"]["signature"],
            "line over output angle: order 7.00 per output turn, amplitude 0.213 arcmin, phase 12 deg");
  EXPECT_EQ(json["corrections"][0]["physical"], false);
}

TEST(ExtendedModel, ReadsBackAsItWasWritten) {
  const daq::ScratchFolder folder;
  const MadeUp made_up = Found();
  ExtendedModel model = ExtendedModelOf(made_up.input, made_up.result, "2026-03-01T12:00:00Z");
  model.nuisance_terms.push_back(
      {"line over output angle", "undecided", {{"order_per_output_turn", "1/turn", 7.0, 0.5}}});
  model.plant.terms.push_back({"creep", false, {{"share_per_decade", 0.125}}, 0});
  model.plant.terms.push_back({"kinematic_input_1", true, {{"amplitude_rad", 1e-7}, {"phase_rad", -3.0}}, 0});
  model.plant.not_run.push_back("nothing else");
  std::ofstream(folder / "extended_model.yaml") << ExtendedModelText(model);
  const ExtendedModel read = ReadExtendedModel(folder / "extended_model.yaml");
  EXPECT_EQ(read.kind, model.kind);
  EXPECT_EQ(read.date, "2026-03-01T12:00:00Z");
  EXPECT_EQ(read.noise_floor, model.noise_floor);
  const auto expect_equal = [](const std::vector<ParameterValue>& a, const std::vector<ParameterValue>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].name, b[i].name);
      EXPECT_EQ(a[i].unit, b[i].unit);
      EXPECT_EQ(a[i].value, b[i].value);
      EXPECT_EQ(a[i].standard_error, std::isfinite(b[i].standard_error) ? b[i].standard_error : 0.0);
    }
  };
  expect_equal(read.nominal, model.nominal);
  ASSERT_EQ(read.causes.size(), 1u);
  EXPECT_EQ(read.causes[0].name, "output_eccentricity");
  EXPECT_EQ(read.causes[0].where, "undecided");
  expect_equal(read.causes[0].parameters, model.causes[0].parameters);
  ASSERT_EQ(read.nuisance_terms.size(), 1u);
  expect_equal(read.nuisance_terms[0].parameters, model.nuisance_terms[0].parameters);
  EXPECT_EQ(NamedCausesOf(read, false).size(), 1u);
  EXPECT_EQ(NamedCausesOf(read, true).size(), 2u);
  EXPECT_EQ(GivenCauses(read, *made_up.input.study, "m.yaml"), std::vector<std::size_t>{0});
}

TEST(ExtendedModel, IsAPlantFileOfTheSimulatedBench) {
  const daq::ScratchFolder folder;
  const MadeUp made_up = Found();
  ExtendedModel model = ExtendedModelOf(made_up.input, made_up.result, "2026-03-01T12:00:00Z");
  std::ofstream(folder / "none.yaml") << ExtendedModelText(model);
  EXPECT_TRUE(ReadPlantFile(folder / "none.yaml").empty());
  model.plant.terms.push_back({"creep", false, {{"share_per_decade", 0.125}}, 0});
  std::ofstream(folder / "one.yaml") << ExtendedModelText(model);
  const auto terms = ReadPlantFile(folder / "one.yaml");
  ASSERT_EQ(terms.size(), 1u);
  EXPECT_EQ(terms[0].name, "creep");
  EXPECT_FALSE(terms[0].enabled);
  EXPECT_EQ(terms[0].parameters, (std::vector<std::pair<std::string, double>>{{"share_per_decade", 0.125}}));
}

TEST(ExtendedModel, SaysWithItsPlaceWhatIsWrongInAFile) {
  const daq::ScratchFolder folder;
  const std::string file = (folder / "m.yaml").string();
  std::ofstream(file) << "plant: 1\nterms: []\ndiagnosis:\n  kind: weather\n  nominal:\n"
                         "    - {parameter: offset_arcmin, value: much}\n";
  try {
    ReadExtendedModel(file);
    FAIL() << "the file was taken";
  } catch (const ModelFileError& error) {
    EXPECT_EQ(std::string(error.what()),
              file +
                  ":4:9: error: kind = weather: not known (expected transmission_error, hysteresis, motion, "
                  "vibration or campaign)\n" +
                  file + ":6:41: error: value = much: not a number (expected a plain number, as in '0.5')");
  }
}

TEST(DiagnosisPictures, AreAllThereAsSvgAndPng) {
  const daq::ScratchFolder folder;
  const MadeUp made_up = Found();
  const auto pictures = DrawDiagnosis(made_up.Report(), folder / "pictures");
  std::vector<std::string> names;
  for (const auto& picture : pictures) {
    names.push_back(picture.filename().string());
    EXPECT_GT(std::filesystem::file_size(picture.string() + ".svg"), 1000u);
    EXPECT_GT(std::filesystem::file_size(picture.string() + ".png"), 1000u);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"measured_over_simulated", "residual",
                                             "residual_over_output_angle", "order_spectrum", "candidates"}));
}

/// `fragment` as the value of `key`, two blanks further in.
std::string Section(const std::string& key, const std::string& fragment) {
  std::string text = key + ":\n";
  std::size_t at = 0;
  while (at < fragment.size()) {
    const std::size_t end = std::min(fragment.find('\n', at), fragment.size());
    text += "  " + fragment.substr(at, end - at) + "\n";
    at = end + 1;
  }
  return text;
}

/// What the reader says of a good schedule with the fragment as the phases of its cycle, or, where a person
/// has to mount the blank for it, as its preparation.
std::string SaidOfScheduleWith(const std::string& fragment) {
  std::string text = schedules::GoodSchedule();
  const std::size_t from = text.find("phases:\n");
  if (fragment.find("kind: blank_test") != std::string::npos) {
    return schedules::MessageOf(text.insert(from, Section("preparation", fragment)));
  }
  return schedules::MessageOf(
      text.replace(from, text.find("measurements:") - from, Section("phases", fragment)));
}

diagnosis::CampaignData SampleCampaign() {
  diagnosis::CampaignData data;
  data.series = {{"k2_Nm_per_rad", {}, {}}, {"e_max_arcmin", {}, {}}};
  for (int cycle = 1; cycle <= 120; ++cycle) {
    data.cycle.push_back(cycle);
    data.time_s.push_back(2400.0 * cycle);
    data.load_time_s.push_back(1800.0 * cycle);
    data.temperature_degC.push_back(35.0 + 3.0 * std::sin(0.17 * cycle));
    data.sensor_serials.push_back(cycle < 60 ? "A" : "B");
    data.series[0].value.push_back(2.5e4 - 3.0 * cycle + 20.0 * std::sin(911.0 * cycle));
    data.series[1].value.push_back(1.0 + 0.001 * cycle + 0.01 * std::sin(577.0 * cycle));
    for (auto& series : data.series) series.standard_error.push_back(series.value.back() * 0.001);
  }
  return data;
}

void ExpectFragmentsToBeSchedules(const diagnosis::Study& study, const std::string& kind) {
  for (const diagnosis::CauseRule& rule : study.causes()) {
    if (rule.to_settle.empty()) continue;
    EXPECT_TRUE(rule.to_settle.starts_with("# ")) << kind << ", " << rule.name << ": " << rule.to_settle;
    if (rule.to_settle.find("\n-") == std::string::npos) continue;  // something to be done by hand
    EXPECT_EQ(SaidOfScheduleWith(rule.to_settle), "") << kind << ", " << rule.name;
  }
}

TEST(MeasurementsToSettle, AreSchedulesForEveryCauseOfEveryKind) {
  for (const StudyKind kind :
       {StudyKind::kTransmissionError, StudyKind::kHysteresis, StudyKind::kMotion, StudyKind::kVibration}) {
    const std::vector<daq::Record> records{UsualExcitation(kind, {.temperature = true, .torque = true})};
    ExpectFragmentsToBeSchedules(*MakeStudy(records), std::string(NameOf(kind)));
  }
  ExpectFragmentsToBeSchedules(*diagnosis::MakeCampaignStudy(SampleCampaign()), "campaign");
}

TEST(MeasurementsToSettle, AreThereForWhatHasNoName) {
  for (const StudyKind kind :
       {StudyKind::kTransmissionError, StudyKind::kHysteresis, StudyKind::kMotion, StudyKind::kVibration}) {
    MadeUp made_up = Unnamed();
    made_up.input.kind = kind;
    const auto entries = MeasurementsToSettle(made_up.Report());
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_EQ(SaidOfScheduleWith(entries[0]), "") << NameOf(kind);
  }
}

}  // namespace
}  // namespace strainwave::bench::diagnosis_files_test
