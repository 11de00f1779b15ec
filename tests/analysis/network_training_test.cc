// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/training.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "tests/analysis/golden.h"
#include "tests/analysis/message_of.h"
#include "tests/analysis/on_threads.h"

namespace strainwave::analysis::networks::network_training_test {
namespace {

Samples<double> RandomSamples(Eigen::Index inputs, Eigen::Index outputs, Eigen::Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Samples<double> samples;
  samples.inputs = Matrix<double>::NullaryExpr(inputs, count, [&] { return normal(random); });
  samples.targets = Matrix<double>::NullaryExpr(outputs, count, [&](Eigen::Index row, Eigen::Index column) {
    return 3.0 + std::tanh(samples.inputs(row % inputs, column) - samples.inputs((row + 1) % inputs, column));
  });
  return samples;
}

TEST(Train, GivesTheSameBitsForTheSameSeedOnAnyNumberOfThreads) {
  const Network network({{1, 6}, {Dense{20, Activation::kSigmoid}, Dense{2}}});
  const Samples<double> samples = RandomSamples(6, 2, 300, 1);
  TrainingOptions options;
  options.epochs = 5;
  options.batch = 64;
  const auto train = [&](std::uint64_t seed, const ParallelFor& parallel) {
    options.seed = seed;
    options.parallel = parallel;
    Vector<double> parameters = InitialParameters<double>(network, 1);
    Train(network, samples, {}, options, parameters);
    return parameters;
  };
  const Vector<double> alone = train(3, InTurn);
  EXPECT_EQ(train(3, OnThreads), alone);
  EXPECT_NE(train(4, InTurn), alone);  // another order of the samples
}

TEST(InitialParameters, AreSpreadAsTheirLayersAskAndTheSameOnEveryMachine) {
  const Network network(
      {{1, 300}, {Dense{200, Activation::kSigmoid}, Dense{100, Activation::kRelu}, Dense{4}}});
  const Vector<double> w = InitialParameters<double>(network, 7);
  double begin = 0.0;
  for (const auto& [weights, biases, bound] :
       {std::tuple{60000.0, 200.0, std::sqrt(6.0 / 500.0)}, {20000.0, 100.0, std::sqrt(6.0 / 200.0)}}) {
    const auto own = w.segment(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(weights));
    EXPECT_NEAR(own.cwiseAbs().maxCoeff(), bound, 1e-3 * bound);
    EXPECT_LE(own.cwiseAbs().maxCoeff(), bound);
    // An even distribution has a standard deviation of bound / √3, known here to half a percent.
    EXPECT_NEAR(std::sqrt(own.squaredNorm() / weights), bound / std::sqrt(3.0), 0.02 * bound);
    EXPECT_EQ(w.segment(static_cast<Eigen::Index>(begin + weights), static_cast<Eigen::Index>(biases)).norm(),
              0.0);
    begin += weights + biases;
  }
  // The first draw of mt19937_64 with its own default seed is 14514284786278117030 (C++ standard's engine).
  const double share = static_cast<double>(14514284786278117030ULL >> 11U) * 0x1p-52 - 1.0;
  EXPECT_EQ(InitialParameters<double>(network, 5489)(0), std::sqrt(6.0 / 500.0) * share);
}

TEST(Train, LearnsWhatItIsShownWithEveryOptimizer) {
  const Network network({{1, 4}, {Dense{16, Activation::kTanh}, Dense{2}}});
  const Samples<double> samples = RandomSamples(4, 2, 256, 2);
  for (const OptimizerSettings& optimizer :
       {OptimizerSettings{Adam{.rate = 0.01}}, OptimizerSettings{MomentumDescent{.rate = 0.02}},
        OptimizerSettings{ResilientPropagation{}}}) {
    TrainingOptions options;
    options.loss = Loss::kMse;
    options.optimizer = optimizer;
    options.epochs = 300;
    options.batch = std::holds_alternative<ResilientPropagation>(optimizer) ? 256 : 32;
    Vector<double> parameters = InitialParameters<double>(network, 1);
    const TrainingHistory history = Train(network, samples, {}, options, parameters);
    EXPECT_LT(history.loss.back(), 0.01 * history.loss.front()) << optimizer.index();
    EXPECT_EQ(history.loss.size(), 300U);
    EXPECT_EQ(history.best_epoch, 299);
  }
}

TEST(Train, StopsEarlyAndGoesBackToTheBestEpoch) {
  const Network network({{1, 4}, {Dense{64, Activation::kTanh}, Dense{1}}});
  Samples<double> training = RandomSamples(4, 1, 24, 3);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (double& target : training.targets.reshaped()) target += normal(random);
  const Samples<double> validation = RandomSamples(4, 1, 200, 4);
  TrainingOptions options;
  options.loss = Loss::kMse;
  options.optimizer = Adam{.rate = 0.02};
  options.epochs = 2000;
  options.early_stopping = EarlyStopping{.patience = 30};
  Vector<double> parameters = InitialParameters<double>(network, 1);
  const TrainingHistory history = Train(network, training, validation, options, parameters);
  EXPECT_EQ(history.end, TrainingEnd::kNoLongerBetter);
  ASSERT_EQ(history.validation_loss.size(), static_cast<std::size_t>(history.best_epoch) + 31);
  BatchGradient<double> batches(network, Loss::kMse, InTurn);
  EXPECT_EQ(batches.ComputeLoss(parameters, validation.inputs, validation.targets),
            history.validation_loss[static_cast<std::size_t>(history.best_epoch)]);
  EXPECT_EQ(*std::min_element(history.validation_loss.begin(), history.validation_loss.end()),
            history.validation_loss[static_cast<std::size_t>(history.best_epoch)]);
}

TEST(Train, EndsWhenTheCallerSaysSo) {
  const Network network({{1, 4}, {Dense{1}}});
  TrainingOptions options;
  options.progress = [](int epoch, double) { return epoch < 2; };
  Vector<double> parameters = InitialParameters<double>(network, 1);
  const TrainingHistory history = Train(network, RandomSamples(4, 1, 10, 1), {}, options, parameters);
  EXPECT_EQ(history.end, TrainingEnd::kByCaller);
  EXPECT_EQ(history.loss.size(), 3U);
}

// With targets that a linear layer meets exactly at w = 2, decay λ moves the minimum to where 2 (w − 2) + λ w
// = 0.
TEST(Train, DecaysWeightsAndNotBiases) {
  const Network network({{1, 1}, {Dense{1}}});
  Samples<double> samples;
  samples.inputs = (Matrix<double>(1, 2) << -1.0, 1.0).finished();
  samples.targets = (Matrix<double>(1, 2) << 3.0, 7.0).finished();
  TrainingOptions options;
  options.loss = Loss::kMse;
  options.optimizer = MomentumDescent{.rate = 0.05, .momentum = 0.5};
  options.weight_decay = 0.5;
  options.epochs = 2000;
  Vector<double> parameters = InitialParameters<double>(network, 1);
  Train(network, samples, {}, options, parameters);
  EXPECT_NEAR(parameters(0), 4.0 / 2.5, 1e-10);
  EXPECT_NEAR(parameters(1), 5.0, 1e-10);
}

TEST(Optimizer, MomentumAddsUpGradients) {
  Optimizer<double> optimizer(MomentumDescent{.rate = 0.1, .momentum = 0.5}, 1);
  Vector<double> w = Vector<double>::Constant(1, 1.0);
  for (const double gradient : {1.0, 2.0, -1.0})
    optimizer.Step(Vector<double>::Constant(1, gradient), 1.0, w);
  // Velocities 1, 2.5, 0.25.
  EXPECT_NEAR(w(0), 1.0 - 0.1 * (1.0 + 2.5 + 0.25), 1e-15);
  optimizer.Step(Vector<double>::Constant(1, 0.0), 0.5, w);
  EXPECT_NEAR(w(0), 1.0 - 0.1 * 3.75 - 0.05 * 0.125, 1e-15);
}

TEST(Optimizer, ResilientStepsFollowTheSignAlone) {
  Optimizer<double> optimizer(ResilientPropagation{.first_step = 0.1}, 1);
  Vector<double> w = Vector<double>::Zero(1);
  std::vector<double> places;
  for (const double gradient : {5.0, 0.01, -3.0, -3.0, -1.0}) {
    optimizer.Step(Vector<double>::Constant(1, gradient), 1.0, w);
    places.push_back(w(0));
  }
  // 0.1; 0.12; sign turned: 0.06, no step; first of the new sign: 0.06; 0.072.
  const double expected[] = {-0.1, -0.22, -0.22, -0.16, -0.088};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(places[i], expected[i], 1e-15) << i;
}

TEST(RateFactor, FollowsItsSchedule) {
  EXPECT_EQ(RateFactor(ConstantRate{}, 7, 10), 1.0);
  EXPECT_EQ(RateFactor(StepRate{.epochs = 3, .factor = 0.5}, 7, 10), 0.25);
  EXPECT_NEAR(RateFactor(ExponentialRate{.factor = 0.9}, 2, 10), 0.81, 1e-15);
  EXPECT_EQ(RateFactor(CosineRate{.last = 0.1}, 0, 11), 1.0);
  EXPECT_NEAR(RateFactor(CosineRate{.last = 0.1}, 5, 11), 0.55, 1e-15);
  EXPECT_NEAR(RateFactor(CosineRate{.last = 0.1}, 10, 11), 0.1, 1e-15);
}

Vector<double> GoldenParameters(const nlohmann::json& object, const std::vector<std::string>& layers) {
  std::vector<double> values;
  const auto flatten = [&](const nlohmann::json& array, const auto& self) -> void {
    if (array.is_number()) return values.push_back(array.get<double>());
    for (const auto& item : array) self(item, self);
  };
  for (const std::string& layer : layers) {
    flatten(object.at(layer + ".weight"), flatten);
    flatten(object.at(layer + ".bias"), flatten);
  }
  return Eigen::Map<Vector<double>>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Matrix<double> GoldenMatrix(const nlohmann::json& rows) {
  const auto values = rows.get<std::vector<std::vector<double>>>();
  return Matrix<double>::NullaryExpr(
      static_cast<Eigen::Index>(values[0].size()), static_cast<Eigen::Index>(values.size()),
      [&](Eigen::Index row, Eigen::Index column) {
        return values[static_cast<std::size_t>(column)][static_cast<std::size_t>(row)];
      });
}

void ExpectPyTorch(const std::string& file, const Design& design, const std::vector<std::string>& layers) {
  const auto golden = nlohmann::json::parse(std::ifstream(*testing_data::GoldenFolder() / file));
  constexpr double kTolerance = 1e-10;
  const Network network(design);
  const Samples<double> samples{GoldenMatrix(golden["input"]), GoldenMatrix(golden["target"])};
  Vector<double> parameters = GoldenParameters(golden["parameters"], layers);
  ASSERT_EQ(parameters.size(), network.parameter_count());
  Pass<double> pass;
  const auto error = [](const auto& got, const auto& expected) {
    return (got - expected).cwiseAbs().maxCoeff();
  };
  EXPECT_LE(error(Forward<double>(network, parameters, samples.inputs, pass), GoldenMatrix(golden["output"])),
            kTolerance);
  BatchGradient<double> batches(network, Loss::kMape, InTurn);
  EXPECT_NEAR(batches.Compute(parameters, samples.inputs, samples.targets),
              golden["mape_loss_percent"].get<double>(), kTolerance);
  EXPECT_LE(error(batches.gradient(), GoldenParameters(golden["gradients"], layers)), kTolerance);
  for (const int steps : {1, 2, 10, 100}) {
    const auto& after = golden["adam"]["after"][std::to_string(steps)];
    TrainingOptions options;
    options.epochs = steps;
    options.batch = 100;
    Vector<double> trained = parameters;
    const TrainingHistory history = Train(network, samples, {}, options, trained);
    EXPECT_NEAR(history.loss.back(), after["loss_before_step"].get<double>(), kTolerance) << steps;
    EXPECT_LE(error(trained, GoldenParameters(after["parameters"], layers)), kTolerance) << steps;
    if (steps == 100) {
      EXPECT_LE(error(Forward<double>(network, trained, samples.inputs, pass),
                      GoldenMatrix(golden["output_after_100_steps"])),
                kTolerance);
    }
  }
}

TEST(Train, EqualsPyTorchOnTheSmallAnn) {
  if (!testing_data::GoldenFolder()) GTEST_SKIP() << testing_data::kNoGolden;
  constexpr Activation kSigmoid = Activation::kSigmoid;
  ExpectPyTorch("tiny_mlp.json",
                {{1, 6}, {Dense{5, kSigmoid}, Dense{4, kSigmoid}, Dense{3, kSigmoid}, Dense{2}}},
                {"0", "2", "4", "6"});
}

TEST(Train, EqualsPyTorchOnTheSmallCnn) {
  if (!testing_data::GoldenFolder()) GTEST_SKIP() << testing_data::kNoGolden;
  constexpr Activation kRelu = Activation::kRelu;
  ExpectPyTorch(
      "tiny_cnn.json",
      {{1, 37},
       {Convolution{4, 6, 1, kRelu}, Convolution{3, 3, 1, kRelu}, MaxPool{3, 2}, Convolution{3, 3, 1, kRelu},
        MaxPool{3, 2}, Convolution{4, 3, 1, kRelu}, GlobalAveragePool{}, Dense{5, kRelu}, Dense{2}}},
      {"c1", "c2", "c3", "c4", "d1", "d2"});
}

TEST(Train, SaysWhatIsWrongWithItsArguments) {
  const Network network({{1, 4}, {Dense{1}}});
  const Samples<double> samples = RandomSamples(4, 1, 10, 1);
  Vector<double> parameters = InitialParameters<double>(network, 1);
  const auto message = [&](const Samples<double>& training, const TrainingOptions& options) {
    return MessageOf([&] { Train(network, training, {}, options, parameters); });
  };
  Samples<double> bad = samples;
  bad.targets(0, 3) = 0.0;
  EXPECT_EQ(message(bad, {}), "training.targets has a zero, of which no error is a share in percent");
  bad.targets(0, 3) = std::nan("");
  EXPECT_EQ(message(bad, {}), "training.targets has a value that is not finite");
  bad = samples;
  bad.inputs.conservativeResize(5, 10);
  EXPECT_EQ(message(bad, {}), "training.inputs is 5 × 10 (expected 4 × 10)");
  EXPECT_EQ(message({Matrix<double>(4, 0), Matrix<double>(1, 0)}, {}),
            "training has no samples (expected at least one)");
  TrainingOptions options;
  options.epochs = 0;
  EXPECT_EQ(message(samples, options), "epochs = 0 is not from 1 up");
  options = {};
  options.batch = 0;
  EXPECT_EQ(message(samples, options), "batch = 0 is not from 1 up");
  options = {};
  options.early_stopping = EarlyStopping{};
  EXPECT_EQ(message(samples, options), "validation has no samples (expected some for early stopping)");
  options = {};
  options.optimizer = Adam{.beta1 = 1.0};
  EXPECT_EQ(message(samples, options), "beta1 = 1 is not from 0 to below 1");
  options.optimizer = MomentumDescent{.rate = -1.0};
  EXPECT_EQ(message(samples, options), "rate = -1 is not a positive number");
  options.optimizer = ResilientPropagation{.first_step = 100.0};
  EXPECT_EQ(message(samples, options), "first_step = 100 is not from least_step = 1e-06 to most_step = 50");
}

TEST(Train, KeepsTheLastGoodParametersWhenItDiverges) {
  const Network network({{1, 4}, {Dense{1}}});
  TrainingOptions options;
  options.loss = Loss::kMse;
  options.optimizer = MomentumDescent{.rate = 1e200};
  Vector<double> parameters = InitialParameters<double>(network, 1);
  EXPECT_THROW(Train(network, RandomSamples(4, 1, 10, 1), {}, options, parameters), std::domain_error);
  EXPECT_TRUE(parameters.allFinite());
}

}  // namespace
}  // namespace strainwave::analysis::networks::network_training_test
