// SPDX-License-Identifier: Apache-2.0
#include "bench/page/cycle_predictor.h"

#include <cmath>

#include <gtest/gtest.h>

namespace strainwave::bench::page_prediction_test {
namespace {

RecordPrediction PredictionOf(std::initializer_list<double> values, double half_width) {
  RecordPrediction prediction;
  prediction.value = Eigen::RowVectorXd(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) prediction.value(i++) = value;
  prediction.half_width = Eigen::RowVectorXd::Constant(i, half_width);
  prediction.distance = 0.5;
  prediction.windows = 3;
  return prediction;
}

Predictor PredictorOf(std::vector<std::string> outputs, bool classes = false) {
  namespace networks = analysis::networks;
  Predictor predictor{.recipe = {},
                      .outputs = std::move(outputs),
                      .fitted = {.ensemble = {.input = {},
                                              .output = {},
                                              .network = networks::Network({{1, 1}, {networks::Dense{1}}}),
                                              .members = {}},
                                 .residual = {},
                                 .band = {},
                                 .novelty = {},
                                 .least = {},
                                 .greatest = {}},
                      .training_json = {}};
  predictor.fitted.band.coverage = 0.9;
  predictor.fitted.ensemble.softmax = classes;
  return predictor;
}

TEST(Prediction, StandsBesideWhatWasMeasured) {
  const Predictor predictor =
      PredictorOf({"k1_Nm_per_rad", "k2_Nm_per_rad", "k3_Nm_per_rad", "e_max_arcmin"});
  const std::vector<Result> measured{{"k1_Nm_per_rad", 104.9, 1.5, ""},
                                     {"k2_Nm_per_rad", 205.1, 1.5, ""},
                                     {"k3_Nm_per_rad", 300.0, 1.5, "the loop did not close"}};
  const auto json = PredictionJson(
      7, predictor, {{"rotation/vibration", PredictionOf({100.0, 200.0, 300.0, 1.0}, 5.0)}}, measured);
  EXPECT_EQ(json["cycle"], 7);
  EXPECT_EQ(json["coverage"], 0.9);
  const auto& record = json["records"][0];
  EXPECT_EQ(record["group"], "rotation/vibration");
  EXPECT_EQ(record["windows"], 3);
  EXPECT_EQ(record["outside_training"], false);
  EXPECT_TRUE(record["outside"].is_null());
  EXPECT_EQ(record["values"]["k1_Nm_per_rad"],
            nlohmann::json({{"value", 100.0},
                            {"low", 95.0},
                            {"high", 105.0},
                            {"measured", {{"value", 104.9}, {"standard_error", 1.5}}},
                            {"inside", true}}));
  EXPECT_EQ(record["values"]["k2_Nm_per_rad"]["inside"], false);
  // What is flagged, and what was not measured, is compared with nothing.
  for (const char* quantity : {"k3_Nm_per_rad", "e_max_arcmin"}) {
    EXPECT_TRUE(record["values"][quantity]["measured"].is_null()) << quantity;
    EXPECT_TRUE(record["values"][quantity]["inside"].is_null()) << quantity;
  }
}

TEST(Prediction, OutsideOfItsTrainingSaysWhy) {
  RecordPrediction prediction = PredictionOf({100.0}, 5.0);
  prediction.distance = 2.0;
  prediction.left = {"output_torque_Nm is 5 (trained at 40.1 to 40.3)"};
  prediction.unknown = {"temperature_degC is not known (trained at 20 to 40)"};
  const auto record = PredictionJson(7, PredictorOf({"k1_Nm_per_rad"}), {{"", prediction}}, {})["records"][0];
  EXPECT_EQ(record["outside_training"], true);
  EXPECT_EQ(record["outside"], OutsideText(2.0, prediction.left));
  EXPECT_EQ(record["warnings"], nlohmann::json(prediction.unknown));
}

TEST(Prediction, OfClassesHasTheirProbabilities) {
  const auto record = PredictionJson(7, PredictorOf({"good", "worn"}, true),
                                     {{"", PredictionOf({0.2, 0.8}, 0.0)}}, {})["records"][0];
  EXPECT_EQ(record["class"], "worn");
  EXPECT_EQ(record["probabilities"], nlohmann::json({{"good", 0.2}, {"worn", 0.8}}));
  EXPECT_FALSE(record.contains("values"));
}

}  // namespace
}  // namespace strainwave::bench::page_prediction_test
