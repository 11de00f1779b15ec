// SPDX-License-Identifier: Apache-2.0
// A predictor of changes, the reducer's baseline file that it needs, and what is refused.
#include "bench/prediction/baseline_file.h"

#include <cmath>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/prediction/exported_predictor.h"
#include "bench/predictor_api/strainwave_predictor.h"
#include "tests/bench/exported_helpers.h"

namespace strainwave::bench::predictor_baseline_test {
namespace {

using Json = nlohmann::ordered_json;

FeatureRecipe RecipeOfChanges() {
  FeatureRecipe recipe = TestRecipe();
  recipe.baseline_records = 5;
  return recipe;
}

// Small ones, each of its own size: what is left of `TestSignals` lies within the training still.
Eigen::RowVectorXd TestFeatures() { return Eigen::RowVectorXd::LinSpaced(12, 0.001, 0.012); }

// Of a reducer of K2 = 1000 Nm/rad and e_max = 2 arcmin.
ReducerBaseline TestBaseline() {
  return {.specimen = "SIM-0007",
          .records = 5,
          .recipe = RecipeOfChanges(),
          .outputs = {"e_max_arcmin", "k1_Nm_per_rad", "k2_Nm_per_rad"},
          .means = {TestFeatures(), Eigen::RowVector3d(2.0, 500.0, 1000.0)}};
}

class APredictorOfChanges : public testing::Test {
 protected:
  void SetUp() override {
    WriteTestExport(exported(), RecipeOfChanges());
    std::ofstream(file()) << BaselineText(TestBaseline());
  }
  std::filesystem::path exported() const { return folder_.path() / "exported"; }
  std::filesystem::path file() const { return folder_.path() / "reducer.json"; }

  void Rewrite(const std::function<void(Json&)>& change) const { RewriteSealed(file(), change); }
  std::string Refusal(const std::filesystem::path& baseline) const {
    ExportedPredictor predictor(exported());
    return RefusalWithin(folder_.path(), [&] { predictor.UseBaseline(baseline); });
  }

  TestFolder folder_;
};

TEST_F(APredictorOfChanges, AddsThemToTheReducersOwnFirstValues) {
  ExportedPredictor predictor(exported());
  predictor.UseBaseline(file());
  const auto signals = TestSignals(3, 1000);
  const auto predicted = predictor.Predict(Named(TestRecipe().channels, signals), 1000.0, {}, {});
  ASSERT_TRUE(std::holds_alternative<PredictedOutputs>(predicted));
  const auto& outputs = std::get<PredictedOutputs>(predicted);

  SignalInputs inputs(RecipeOfChanges());
  Eigen::RowVectorXd features;
  inputs.Compute(Named(TestRecipe().channels, signals), 1000.0, std::nullopt, features);
  OnnxNetwork network(ReadText(exported() / "model.onnx"), 12, 2);
  const OnnxNetwork::Output change = network.Run(features - TestFeatures());
  EXPECT_EQ(outputs.value, (std::vector{1000.0 + change.prediction(0), 2.0 + change.prediction(1)}));
  EXPECT_EQ(outputs.half_width, (std::vector{change.half_width(0), change.half_width(1)}));
  EXPECT_EQ(outputs.distance, change.distance);
  EXPECT_NE(change.prediction, network.Run(features).prediction);
}

TEST_F(APredictorOfChanges, IsRefusedWithoutABaseline) {
  EXPECT_EQ(
      Refusal({}),
      "error: the predictor tells changes since a reducer's first 5 records (expected its baseline file, "
      "as `strainwave baseline` writes it)");
  ExportedPredictor predictor(exported());
  EXPECT_THROW(predictor.Predict(Named(TestRecipe().channels, TestSignals(3, 1000)), 1000.0, {}, {}),
               std::logic_error);
}

TEST_F(APredictorOfChanges, RefusesAFileThatIsNotOfItsFeatures) {
  EXPECT_EQ(Refusal(file()), "accepted");
  Rewrite([](Json& json) { json["recipe"]["sample_rate_hz"] = 500.0; });
  EXPECT_EQ(
      Refusal(file()),
      "reducer.json: error: sample_rate_hz of its features is 500.0 (expected 1000.0, as the predictor's)");
  Rewrite([](Json& json) {
    json["recipe"]["sample_rate_hz"] = 1000.0;
    json["features"].erase("accel_x_m_per_s2.a1.root_mean_square");
  });
  EXPECT_EQ(
      Refusal(file()),
      "reducer.json: error: there is no baseline of accel_x_m_per_s2.a1.root_mean_square (expected one of "
      "every input of the predictor)");
  std::ofstream(file()) << BaselineText(TestBaseline());
  Rewrite([](Json& json) { json["values"].erase("k2_Nm_per_rad"); });
  EXPECT_EQ(Refusal(file()),
            "reducer.json: error: there is no baseline of k2_Nm_per_rad (expected one of every output of the "
            "predictor)");
}

TEST_F(APredictorOfChanges, RefusesAFileThatWasChanged) {
  std::string changed = ReadText(file());
  changed.replace(changed.find("500.0"), 5, "501.0");
  std::ofstream(file()) << changed;
  EXPECT_EQ(
      Refusal(file()),
      "reducer.json: error: the file has changed since it was written (expected the SHA-256 that it has of "
      "itself)");
  Rewrite([](Json& json) { json["format"] = 2; });
  EXPECT_EQ(Refusal(file()), "reducer.json: error: format 2 (expected format 1)");
  std::ofstream(file()) << "{";
  EXPECT_TRUE(Refusal(file()).starts_with("reducer.json: error: cannot be used: ")) << Refusal(file());
  EXPECT_EQ(Refusal(folder_.path() / "none.json"),
            "none.json: error: cannot be read (expected a file as `strainwave baseline` writes it)");
}

TEST_F(APredictorOfChanges, OfValuesTakesNone) {
  std::filesystem::remove_all(exported());
  WriteTestExport(exported());
  EXPECT_EQ(Refusal({}), "accepted");
  EXPECT_EQ(Refusal(file()), "reducer.json: error: the predictor takes no baseline (expected none)");
}

TEST_F(APredictorOfChanges, NeedsTheFileFromCToo) {
  char error[400];
  EXPECT_EQ(strainwave_predictor_open(exported().c_str(), error, sizeof error), nullptr);
  EXPECT_EQ(
      std::string(error),
      "error: the predictor tells changes since a reducer's first 5 records (expected its baseline file, "
      "as `strainwave baseline` writes it)");
  EXPECT_EQ(strainwave_predictor_open_for(exported().c_str(), nullptr, error, sizeof error), nullptr);
  EXPECT_EQ(std::string(error), "baseline_file is NULL (expected a file that `strainwave baseline` wrote)");
  strainwave_predictor* predictor =
      strainwave_predictor_open_for(exported().c_str(), file().c_str(), error, sizeof error);
  ASSERT_NE(predictor, nullptr) << error;
  strainwave_predictor_close(predictor);
}

TEST_F(APredictorOfChanges, LeavesNoOldValueWhereTheSpeedIsNoNumber) {
  char error[400];
  strainwave_predictor* predictor =
      strainwave_predictor_open_for(exported().c_str(), file().c_str(), error, sizeof error);
  ASSERT_NE(predictor, nullptr) << error;
  const auto signals = TestSignals(3, 1000);
  const double* const channels[] = {signals[0].data(), signals[1].data(), signals[2].data()};
  for (const double speed_rpm : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
    strainwave_value values[2] = {{1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}};
    double distance = 1.0;
    EXPECT_EQ(strainwave_predictor_run_at(predictor, channels, 1000, 1000.0, speed_rpm, values, &distance,
                                          error, sizeof error),
              STRAINWAVE_BAD_ARGUMENT);
    EXPECT_EQ(std::string(error),
              "input_speed_rpm is 0 or no number (expected the speed of a shaft that turns)");
    EXPECT_TRUE(std::isnan(values[0].value) && std::isnan(values[1].high) && std::isnan(distance));
  }
  strainwave_predictor_close(predictor);
}

}  // namespace
}  // namespace strainwave::bench::predictor_baseline_test
