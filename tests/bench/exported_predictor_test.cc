// SPDX-License-Identifier: Apache-2.0
// A folder that leaves the house: whole, or refused in words.
#include "bench/prediction/exported_predictor.h"

#include <fstream>
#include <random>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/prediction/onnx_model.h"
#include "bench/sha256.h"
#include "tests/bench/exported_helpers.h"

namespace strainwave::bench::exported_predictor_test {
namespace {

using Json = nlohmann::ordered_json;

class AnExportedFolder : public testing::Test {
 protected:
  void SetUp() override { WriteTestExport(folder_.path()); }

  std::filesystem::path File(const std::string& name) const { return folder_.path() / name; }
  void Write(const std::string& name, const std::string& content) const {
    std::ofstream(File(name), std::ios::binary) << content;
  }
  void Rewrite(const std::function<void(Json&)>& change) const { RewriteSealed(File("recipe.json"), change); }
  // What opening it is refused with, without the folder's own name.
  std::string Refusal() const {
    return RefusalWithin(folder_.path(), [this] { ExportedPredictor predictor(folder_.path()); });
  }
  std::string FaultOf(const std::vector<std::vector<double>>& signals, double rate_hz = 1000.0) const {
    return FaultOf(Named(TestRecipe().channels, signals), rate_hz);
  }
  std::string FaultOf(const std::vector<NamedSignal>& signals, double rate_hz = 1000.0) const {
    ExportedPredictor predictor(folder_.path());
    const auto predicted = predictor.Predict(signals, rate_hz, {}, {});
    const auto* fault = std::get_if<SignalFault>(&predicted);
    return fault == nullptr ? "none" : std::string(NameOf(fault->kind)) + ": " + fault->text;
  }

  TestFolder folder_;
};

TEST_F(AnExportedFolder, PassesItsSelfTest) {
  ExportedPredictor predictor(folder_.path());
  EXPECT_LE(predictor.worst_disagreement(), kExportAgreement);
  EXPECT_EQ(predictor.outputs(), (std::vector<std::string>{"k2_Nm_per_rad", "e_max_arcmin"}));
  EXPECT_EQ(predictor.coverage(), 0.9);
}

TEST_F(AnExportedFolder, PredictsWhatTheTrainedNetworksPredict) {
  using analysis::networks::Activation;
  using analysis::networks::Dense;
  const FeatureRecipe recipe = TestRecipe();
  const Predictor trained =
      TestPredictor(recipe, {{1, 12}, {Dense{6, Activation::kTanh}, Dense{2, Activation::kLinear}}}, 3);
  const auto signals = TestSignals(3, 1200, 9);
  SignalInputs inputs(recipe);
  Eigen::RowVectorXd features;
  ASSERT_FALSE(inputs.Compute(Named(recipe.channels, signals), 1000.0, std::nullopt, features));
  const auto expected = trained.fitted.Predict(features);
  ExportedPredictor predictor(folder_.path());
  const auto predicted =
      std::get<PredictedOutputs>(predictor.Predict(Named(recipe.channels, signals), 1000.0, {}, {}));
  EXPECT_FALSE(predicted.outside_training());
  for (std::size_t i = 0; i < 2; ++i) {
    const double value = expected.value(0, static_cast<Eigen::Index>(i));
    EXPECT_NEAR(predicted.value[i], value, kExportAgreement * std::abs(value));
  }
}

TEST_F(AnExportedFolder, IsRefusedWhenAnyFileOfItHasChanged) {
  for (const char* name : {"model.onnx", "model_card.json", "model_card.md"}) {
    const std::string whole = ReadText(File(name));
    std::string changed = whole;
    changed[changed.size() / 2] ^= 1;
    Write(name, changed);
    EXPECT_EQ(Refusal(), std::string(name) +
                             ": error: the file has changed since it was written (expected the SHA-256 that "
                             "recipe.json has of it)");
    Write(name, whole);
  }
  const std::string recipe = ReadText(File("recipe.json"));
  std::string changed = recipe;
  changed.replace(changed.find("1000.0"), 6, "2000.0");
  Write("recipe.json", changed);
  EXPECT_EQ(
      Refusal(),
      "recipe.json: error: the file has changed since it was written (expected the SHA-256 that it has of "
      "itself)");
  Write("recipe.json", recipe);
  EXPECT_EQ(Refusal(), "accepted");
}

TEST_F(AnExportedFolder, IsRefusedWhenAFileIsMissingOrOfAnOlderFormat) {
  Rewrite([](Json& json) { json["format"] = 1; });
  EXPECT_EQ(Refusal(), "recipe.json: error: format 1 (expected format 2; export the predictor again)");
  std::filesystem::remove(File("model.onnx"));
  Rewrite([](Json& json) { json["format"] = 2; });
  EXPECT_EQ(Refusal(),
            "model.onnx: error: cannot be read (expected a folder that `strainwave export` wrote)");
  std::filesystem::remove(File("recipe.json"));
  EXPECT_EQ(Refusal(),
            "recipe.json: error: cannot be read (expected a folder that `strainwave export` wrote)");
}

TEST_F(AnExportedFolder, IsRefusedWhenTheNetworkIsNotTheOneThatWasTrained) {
  Rewrite([](Json& json) {
    json["self_test"][0]["prediction"][0] = json["self_test"][0]["prediction"][0].get<double>() * 1.0001;
  });
  EXPECT_EQ(
      Refusal(),
      "model.onnx: error: the self-test fails: off the golden vectors by 1.0e-04 (expected at most 1e-05)");
}

TEST_F(AnExportedFolder, IsRefusedWithANetworkOfAnotherShape) {
  Rewrite([](Json& json) { json["outputs"].push_back("k3_Nm_per_rad"); });
  EXPECT_EQ(Refusal().substr(0, 60), "recipe.json: error: cannot be used: a golden vector has 2 va");
  Rewrite([](Json& json) {
    for (Json& golden : json["self_test"]) {
      golden["prediction"].push_back(1.0);
      golden["half_width"].push_back(1.0);
    }
  });
  EXPECT_EQ(Refusal(),
            "model.onnx: error: the ONNX file has 'prediction' where 'prediction' of records × 3 should be "
            "(expected one "
            "that `strainwave export` wrote)");
}

TEST_F(AnExportedFolder, IsRefusedWithNamesThatFitNoTopicOrTable) {
  Rewrite([](Json& json) { json["outputs"][0] = "k2/#"; });
  EXPECT_EQ(
      Refusal(),
      "recipe.json: error: the outputs have no proper names (expected 1 to 256 different names of letters, "
      "digits and '_')");
}

// Whatever the network file is, and though its hash fits: an answer in words, or the same values.
TEST_F(AnExportedFolder, OutlivesAHostileNetworkWhoseHashFits) {
  const std::string whole = ReadText(File("model.onnx"));
  std::mt19937 engine(5);
  int refused = 0;
  for (int k = 0; k < 400; ++k) {
    std::string damaged = whole;
    for (int i = 0; i < 4; ++i) damaged[engine() % damaged.size()] = static_cast<char>(engine());
    if (k % 4 == 0) damaged.resize(engine() % damaged.size());
    Write("model.onnx", damaged);
    Rewrite([&](Json& json) { json["model"]["sha256"] = Sha256(damaged); });
    const std::string refusal = Refusal();
    EXPECT_TRUE(refusal == "accepted" || refusal.starts_with("model.onnx: error: ")) << refusal;
    refused += refusal != "accepted";
  }
  EXPECT_GT(refused, 200);
}

TEST_F(AnExportedFolder, OutlivesAHostileDescription) {
  const std::string whole = ReadText(File("recipe.json"));
  std::mt19937 engine(6);
  for (int k = 0; k < 400; ++k) {
    Rewrite([&](Json& json) {
      auto at = json.begin();
      std::advance(at, static_cast<std::ptrdiff_t>(engine() % json.size()));
      const Json values[] = {nullptr, -1, 1e300, "", Json::array(), Json::object(), {1, 2}, true};
      if (at.value().is_object() && k % 2 == 0) {
        auto inner = at.value().begin();
        std::advance(inner, static_cast<std::ptrdiff_t>(engine() % at.value().size()));
        inner.value() = values[engine() % std::size(values)];
      } else {
        at.value() = values[engine() % std::size(values)];
      }
    });
    EXPECT_FALSE(Refusal().empty());
    Write("recipe.json", whole.substr(0, k % 3 == 0 ? engine() % whole.size() : whole.size()));
    EXPECT_FALSE(Refusal().empty());
    Write("recipe.json", whole);
  }
}

TEST_F(AnExportedFolder, FindsWhatIsWrongWithSignals) {
  const auto good = TestSignals(3, 1000, 2);
  EXPECT_EQ(FaultOf(good), "none");
  EXPECT_EQ(FaultOf(good, 500.0),
            "sample_rate: the sampling rate is 500 Hz (expected 1000 Hz, as in training)");
  EXPECT_EQ(FaultOf(TestSignals(3, 900)), "too_short: 900 samples (expected at least 1000, as in training)");
  EXPECT_EQ(FaultOf(good, NAN),
            "sample_rate: the sampling rate is nan Hz (expected 1000 Hz, as in training)");
  auto odd = good;
  odd[1][17] = NAN;
  EXPECT_EQ(FaultOf(odd), "not_finite: accel_y_m_per_s2 is nan at sample 18 (expected a number)");
  odd[1][17] = 1e200;
  EXPECT_EQ(
      FaultOf(odd),
      "not_finite: accel_y_m_per_s2 is 1e+200 at sample 18 (expected a number from -1e+07 to 1e+07 m/s^2)");
  odd[1].assign(1000, 0.25);
  EXPECT_EQ(FaultOf(odd),
            "dead: accel_y_m_per_s2 is 0.25 throughout (expected a signal: is the sensor connected?)");
  odd = good;
  for (double& value : odd[2]) value = std::clamp(value, -2.5, 2.0);
  EXPECT_TRUE(FaultOf(odd).starts_with("clipped: accel_z_m_per_s2 stays at its end value ")) << FaultOf(odd);
  const std::vector<std::string> channels = TestRecipe().channels;
  auto named = Named(channels, good);
  named.erase(named.begin());
  EXPECT_EQ(
      FaultOf(named),
      "missing_channel: there is no channel accel_x_m_per_s2 (expected accel_x_m_per_s2, accel_y_m_per_s2, "
      "accel_z_m_per_s2)");
}

TEST_F(AnExportedFolder, TellsExchangedChannelsFromAnotherGear) {
  auto exchanged = TestSignals(3, 1000, 2);
  std::swap(exchanged[0], exchanged[2]);
  EXPECT_EQ(FaultOf(exchanged),
            "swapped: accel_x_m_per_s2 and accel_z_m_per_s2 seem to be exchanged (expected the sensors as in "
            "training)");
  auto loud = TestSignals(3, 1000, 2);
  for (auto& channel : loud) {
    for (double& value : channel) value *= 4.0;
  }
  ExportedPredictor predictor(folder_.path());
  const auto predicted = predictor.Predict(Named(TestRecipe().channels, loud), 1000.0, {}, {});
  ASSERT_TRUE(std::holds_alternative<PredictedOutputs>(predicted));
  EXPECT_TRUE(std::get<PredictedOutputs>(predicted).outside_training());
}

}  // namespace
}  // namespace strainwave::bench::exported_predictor_test
