// SPDX-License-Identifier: Apache-2.0
// Hostile predictors: whatever a file holds, it is refused in words or it can be used; nothing ends the
// program. Longer: STRAINWAVE_FUZZ_ROUNDS=200000 ctest --preset release -R predictor_fuzz_test
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <onnx/onnx_pb.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/folder.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/onnx_model.h"
#include "bench/prediction/onnx_network.h"
#include "bench/prediction/predictor_file.h"
#include "bench/prediction/recipe_inputs.h"
#include "tests/bench/random_predictor.h"

namespace strainwave::bench::predictor_fuzz_test {
namespace {

namespace fs = std::filesystem;
namespace networks = analysis::networks;
using Json = nlohmann::ordered_json;

int Rounds() {
  const char* text = std::getenv("STRAINWAVE_FUZZ_ROUNDS");
  return text != nullptr ? std::atoi(text) : 600;
}

// Numbers that programs trip over.
std::int64_t OddNumber(std::mt19937& engine) {
  constexpr std::int64_t kOdd[] = {0, -1, 1, 2, 7, 1 << 16, std::int64_t{1} << 31, std::int64_t{1} << 62};
  return kOdd[engine() % std::size(kOdd)];
}

std::string RefusalOf(const std::string& bytes, Eigen::Index inputs, Eigen::Index outputs,
                      OnnxNetwork::Predicts predicts = OnnxNetwork::Predicts::kValues) {
  try {
    OnnxNetwork network(bytes, inputs, outputs, predicts);
    network.Run(Eigen::RowVectorXd::Constant(inputs, 0.5));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

analysis::prediction::FittedPredictor SmallCnn() {
  return RandomPredictor(
      {{1, 12},
       {networks::Convolution{3, 4, 1, networks::Activation::kRelu}, networks::MaxPool{3, 2},
        networks::Dense{4, networks::Activation::kTanh}, networks::Dense{2}}},
      2);
}

void DamageGraph(onnx::GraphProto& graph, std::mt19937& engine) {
  onnx::NodeProto& node =
      *graph.mutable_node(static_cast<int>(engine() % static_cast<unsigned>(graph.node_size())));
  onnx::TensorProto& tensor = *graph.mutable_initializer(
      static_cast<int>(engine() % static_cast<unsigned>(graph.initializer_size())));
  switch (engine() % 8) {
    case 0:
      node.set_op_type(
          graph.node(static_cast<int>(engine() % static_cast<unsigned>(graph.node_size()))).op_type());
      return;
    case 1:
      if (node.input_size() > 0) node.mutable_input()->RemoveLast();
      return;
    case 2:
      if (node.input_size() > 0) *node.mutable_input(0) = tensor.name();
      return;
    case 3:
      if (node.attribute_size() > 0) {
        onnx::AttributeProto& attribute = *node.mutable_attribute(0);
        attribute.set_i(OddNumber(engine));
        if (attribute.ints_size() > 1) attribute.set_ints(1, OddNumber(engine));
      }
      return;
    case 4:
      if (tensor.dims_size() > 0) tensor.set_dims(0, OddNumber(engine));
      return;
    case 5:
      if (tensor.dims_size() > 1) tensor.mutable_dims()->SwapElements(0, 1);
      return;
    case 6:
      if (tensor.int64_data_size() > 0) tensor.set_int64_data(1, OddNumber(engine));
      return;
    default:
      node.clear_attribute();
      return;
  }
}

TEST(HostileNetwork, OutlivesGraphsThatAreOddInTheirShapes) {
  onnx::ModelProto whole;
  ASSERT_TRUE(whole.ParseFromString(OnnxBytes(SmallCnn(), {})));
  ASSERT_EQ(RefusalOf(whole.SerializeAsString(), 12, 2), "accepted");
  std::mt19937 engine(5);
  int refused = 0;
  for (int round = 0; round < Rounds(); ++round) {
    onnx::ModelProto damaged = whole;
    const unsigned changes = 1 + engine() % 2;
    for (unsigned i = 0; i < changes; ++i) DamageGraph(*damaged.mutable_graph(), engine);
    refused += RefusalOf(damaged.SerializeAsString(), 12, 2) != "accepted";
  }
  EXPECT_GT(refused, Rounds() / 4);
}

TEST(HostileNetwork, OutlivesFlippedAndMissingBytes) {
  const std::string whole = OnnxBytes(SmallCnn(), {});
  std::mt19937 engine(6);
  for (int round = 0; round < Rounds(); ++round) {
    std::string damaged = whole;
    damaged[engine() % damaged.size()] ^= static_cast<char>(1U << (engine() % 8));
    if (round % 3 == 0) damaged.resize(engine() % damaged.size());
    const std::string refusal = RefusalOf(damaged, 12, 2);
    if (refusal != "accepted") {
      EXPECT_TRUE(refusal.starts_with("the ONNX file ")) << refusal;
    }
  }
}

TEST(HostileNetwork, SaysWhatIsOddInANode) {
  onnx::ModelProto model;
  ASSERT_TRUE(model.ParseFromString(OnnxBytes(SmallCnn(), {})));
  onnx::ModelProto strides = model;
  for (onnx::NodeProto& node : *strides.mutable_graph()->mutable_node()) {
    if (node.op_type() == "MaxPool") node.mutable_attribute(1)->set_ints(1, 0);
  }
  EXPECT_EQ(
      RefusalOf(strides.SerializeAsString(), 12, 2),
      "the ONNX file has a node 'member0_layer1_pooled' with an odd 'strides' (expected one that `strainwave "
      "export` wrote)");
  onnx::ModelProto inputs = model;
  inputs.mutable_graph()->mutable_node(0)->mutable_input()->RemoveLast();
  EXPECT_EQ(RefusalOf(inputs.SerializeAsString(), 12, 2),
            "the ONNX file has a node 'centred' of 1 inputs (expected one that `strainwave export` wrote)");
  onnx::ModelProto huge = model;
  huge.mutable_graph()->mutable_initializer(0)->set_dims(1, std::int64_t{1} << 40);
  EXPECT_EQ(RefusalOf(huge.SerializeAsString(), 12, 2),
            "the ONNX file has an array 'input_offset' of size 1099511627776 (expected one that `strainwave "
            "export` "
            "wrote)");
}

class PredictorFolder : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("strainwave_fuzz_" + std::to_string(::getpid()));
    FeatureRecipe recipe;
    recipe.channels = {"accel_x_m_per_s2"};
    recipe.sample_rate_hz = 12000.0;
    recipe.window.turns = 8;
    recipe.least_samples = 3000;
    recipe.inputs = {"accel_x_m_per_s2.a1.mean", "accel_x_m_per_s2.a2.median"};
    const networks::Design design{{1, 2},
                                  {networks::Dense{3, networks::Activation::kTanh}, networks::Dense{2}}};
    const Predictor predictor{std::move(recipe),
                              {"cracked", "sound"},
                              RandomPredictor(design, 2, Head::kClasses),
                              R"({"data_sha256": "0"})"};
    WritePredictor(folder_, predictor);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string Read(const fs::path& file) { return ReadText(file); }
  static void Write(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
  }

  std::string Refusal() const {
    try {
      const Predictor predictor = ReadPredictor(folder_);
      RecipeInputs inputs(predictor.recipe);
      predictor.fitted.Predict(Eigen::MatrixXd::Ones(2, predictor.fitted.ensemble.network.input_size()));
    } catch (const BenchError& error) {
      return error.what();
    }
    return "accepted";
  }

  fs::path folder_;
};

TEST_F(PredictorFolder, KeepsTheLineBesideTheNetworks) {
  Predictor predictor = ReadPredictor(folder_);
  predictor.fitted =
      RandomPredictor({{1, 2}, {networks::Dense{3}, networks::Dense{2}}}, 2, Head::kValues, true);
  predictor.outputs = {"k1_Nm_per_rad", "k2_Nm_per_rad"};
  WritePredictor(folder_, predictor);
  const Eigen::MatrixXd features = Eigen::MatrixXd::Constant(1, 2, 1.5);
  EXPECT_EQ(ReadPredictor(folder_).fitted.Predict(features).value, predictor.fitted.Predict(features).value);
}

TEST_F(PredictorFolder, OutlivesADamagedDescription) {
  ASSERT_EQ(Refusal(), "accepted");
  const std::string whole = Read(folder_ / "predictor.json");
  std::mt19937 engine(8);
  int refused = 0;
  for (int round = 0; round < Rounds(); ++round) {
    std::string damaged = whole;
    for (unsigned i = 0; i < 1 + engine() % 3; ++i)
      damaged[engine() % damaged.size()] = static_cast<char>(engine());
    if (round % 4 == 0) damaged.resize(engine() % damaged.size());
    Write(folder_ / "predictor.json", damaged);
    refused += Refusal() != "accepted" ? 1 : 0;
  }
  EXPECT_GE(refused, Rounds() / 4) << "every fourth is cut short";
}

TEST_F(PredictorFolder, OutlivesOddNumbersInItsDescription) {
  const Json whole = Json::parse(Read(folder_ / "predictor.json"));
  const Json flat = whole.flatten();
  std::mt19937 engine(9);
  int refused = 0;
  for (int round = 0; round < Rounds(); ++round) {
    Json damaged = flat;
    auto place = damaged.begin();
    std::advance(place, static_cast<int>(engine() % damaged.size()));
    *place = engine() % 4 == 0 ? Json("odd") : Json(OddNumber(engine));
    Write(folder_ / "predictor.json", damaged.unflatten().dump());
    refused += Refusal() != "accepted" ? 1 : 0;
  }
  EXPECT_GT(refused, 0);
}

TEST_F(PredictorFolder, RefusesWhatDoesNotFit) {
  const Json whole = Json::parse(Read(folder_ / "predictor.json"));
  const auto refusal_with = [&](const char* place, const Json& value) {
    Json changed = whole;
    changed[Json::json_pointer(place)] = value;
    Write(folder_ / "predictor.json", changed.dump());
    std::string text = Refusal();
    const auto at = text.find(folder_.string() + "/");
    return at == 0 ? text.substr(folder_.string().size() + 1) : text;
  };
  EXPECT_EQ(refusal_with("/network/layers/0/dense", 2'000'000'000),
            "predictor.json: error: cannot be used: a sample of 2000000000 × 1 values is too large (expected "
            "at most "
            "67108864) (expected the file as it was written)");
  EXPECT_EQ(refusal_with("/members", std::int64_t{1} << 60),
            "numbers.h5: error: the array 'members' is missing or of another shape (expected " +
                std::to_string((std::uint64_t{1} << 60) * 17) + " values, as predictor.json says)");
  EXPECT_EQ(
      refusal_with("/recipe/sample_rate_hz", 0),
      "predictor.json: error: the recipe cannot be used: sample_rate_hz is not above 0 (expected the file as "
      "`strainwave train` or `export` has written it)");
  EXPECT_EQ(refusal_with("/recipe/set", "letters"),
            "predictor.json: error: the recipe cannot be used: set = 'letters' is not known (expected "
            "wavelet, orders, "
            "details, envelope_orders or packets) (expected the file as `strainwave train` or `export` has "
            "written it)");
}

TEST_F(PredictorFolder, RefusesALayerInFewWordsHoweverLongItIs) {
  const Json whole = Json::parse(Read(folder_ / "predictor.json"));
  const auto refusal_with = [&](const char* place, const Json& value) {
    Json changed = whole;
    changed[Json::json_pointer(place)] = value;
    Write(folder_ / "predictor.json", changed.dump());
    return Refusal();
  };
  const std::string file = (folder_ / "predictor.json").string() + ": error: cannot be used: ";
  const std::string as_written = " (expected the file as it was written)";
  const std::string text(5000, 'x');
  EXPECT_EQ(refusal_with("/network/layers/0", {{"sparse", text}}),
            file + R"(layer {"sparse":")" + std::string(49, 'x') +
                "... (expected dense, convolution, max_pool or global_average_pool)" + as_written);
  EXPECT_EQ(refusal_with("/network/layers/0/activation", text),
            file + "activation \"" + std::string(59, 'x') + "... (expected linear, relu, sigmoid or tanh)" +
                as_written);
}

// libhdf5 itself does not outlive every damaged file: the checksum is read before it is asked.
TEST_F(PredictorFolder, RefusesDamagedNumbersBeforeHdf5SeesThem) {
  const std::string whole = Read(folder_ / "numbers.h5");
  std::mt19937 engine(10);
  for (int round = 0; round < Rounds() / 3; ++round) {
    std::string damaged = whole;
    damaged[engine() % damaged.size()] ^= static_cast<char>(1U << (engine() % 8));
    if (round % 4 == 0) damaged.resize(engine() % damaged.size());
    Write(folder_ / "numbers.h5", damaged);
    EXPECT_EQ(Refusal(), (folder_ / "numbers.h5").string() +
                             ": error: the file has changed since it was written (expected the SHA-256 that "
                             "predictor.json has of it)");
  }
}

}  // namespace
}  // namespace strainwave::bench::predictor_fuzz_test
