// SPDX-License-Identifier: Apache-2.0
// Values against loops over the definitions, gradients against differences of the values.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "analysis/networks/batch_gradient.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::networks::network_gradient_test {
namespace {

constexpr Activation kActivations[] = {Activation::kLinear, Activation::kRelu, Activation::kSigmoid,
                                       Activation::kTanh};

Matrix<double> Random(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Matrix<double>::NullaryExpr(rows, columns, [&] { return normal(random); });
}

double Function(Activation activation, double z) {
  switch (activation) {
    case Activation::kLinear:
      return z;
    case Activation::kRelu:
      return z > 0.0 ? z : 0.0;
    case Activation::kSigmoid:
      return 1.0 / (1.0 + std::exp(-z));
    case Activation::kTanh:
      return std::tanh(z);
  }
  return 0.0;
}

TEST(Forward, OfADenseLayerIsItsSum) {
  for (const Activation activation : kActivations) {
    const Network network({{2, 3}, {Dense{4, activation}}});
    const Vector<double> w = Random(network.parameter_count(), 1, 1);
    const Matrix<double> x = Random(6, 5, 2);
    Pass<double> pass;
    const Matrix<double> y = Forward<double>(network, w, x, pass);
    for (Eigen::Index sample = 0; sample < 5; ++sample) {
      for (Eigen::Index unit = 0; unit < 4; ++unit) {
        double z = w(24 + unit);
        for (Eigen::Index i = 0; i < 6; ++i) z += w(unit * 6 + i) * x(i, sample);
        EXPECT_NEAR(y(unit, sample), Function(activation, z), 1e-13);
      }
    }
  }
}

TEST(Forward, OfAConvolutionIsItsSumOverChannelsAndKernel) {
  const Network network({{3, 11}, {Convolution{2, 4, 2, Activation::kTanh}}});
  ASSERT_EQ(network.stages()[0].output, (Shape{2, 4}));
  const Vector<double> w = Random(network.parameter_count(), 1, 3);
  const Matrix<double> x = Random(33, 2, 4);
  Pass<double> pass;
  const Matrix<double> y = Forward<double>(network, w, x, pass);
  for (Eigen::Index sample = 0; sample < 2; ++sample) {
    for (Eigen::Index filter = 0; filter < 2; ++filter) {
      for (Eigen::Index place = 0; place < 4; ++place) {
        double z = w(24 + filter);
        for (Eigen::Index channel = 0; channel < 3; ++channel) {
          for (Eigen::Index k = 0; k < 4; ++k) {
            z += w((filter * 3 + channel) * 4 + k) * x(channel * 11 + 2 * place + k, sample);
          }
        }
        EXPECT_NEAR(y(filter * 4 + place, sample), std::tanh(z), 1e-13);
      }
    }
  }
}

TEST(Forward, PoolsSeriesBySeries) {
  const Network network({{2, 7}, {MaxPool{3, 2}, GlobalAveragePool{}}});
  EXPECT_EQ(network.parameter_count(), 0);
  Matrix<double> x(14, 1);
  x << 1, 5, 2, 2, 9, -1, 0, -3, -4, -5, -1, -2, -8, -7;
  Pass<double> pass;
  const Matrix<double> y = Forward<double>(network, Vector<double>(0), x, pass);
  EXPECT_EQ(pass.outputs[0], (Matrix<double>(6, 1) << 5, -3, 9, -1, 9, -2).finished());
  EXPECT_NEAR(y(0), 23.0 / 3.0, 1e-15);
  EXPECT_NEAR(y(1), -2.0, 1e-15);
}

// ∂loss/∂w by central differences of a loss of size one: steps of 1e-6 leave about 1e-9.
void ExpectGradientOfDifferences(const Design& design, Loss loss, const std::string& what) {
  const Network network(design);
  Vector<double> w = InitialParameters<double>(network, 5);
  w += 0.1 * Random(w.size(), 1, 6);
  const Matrix<double> x = Random(network.input_size(), 37, 7);
  Matrix<double> y = Random(network.output_size(), 37, 8).array() + 3.0;
  if (loss == Loss::kCrossEntropy) {
    y = y.array().abs();
    y.array().rowwise() /= y.colwise().sum().array().eval();
  }
  BatchGradient<double> batches(network, loss, InTurn);
  const double value = batches.Compute(w, x, y);
  EXPECT_NEAR(batches.ComputeLoss(w, x, y), value, 1e-12 * std::abs(value)) << what;
  batches.Compute(w, x, y);
  const Vector<double> gradient = batches.gradient();
  const double scale = std::max(1.0, gradient.cwiseAbs().maxCoeff());
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    constexpr double kStep = 1e-6;
    Vector<double> up = w;
    Vector<double> down = w;
    up(i) += kStep;
    down(i) -= kStep;
    const double slope = (batches.ComputeLoss(up, x, y) - batches.ComputeLoss(down, x, y)) / (2.0 * kStep);
    ASSERT_NEAR(gradient(i), slope, 2e-7 * scale) << what << " parameter " << i;
  }
}

TEST(Backward, IsTheSlopeOfEveryLossThroughDenseLayers) {
  for (const Loss loss : {Loss::kMape, Loss::kMse, Loss::kMae, Loss::kCrossEntropy}) {
    for (const Activation activation : kActivations) {
      ExpectGradientOfDifferences({{1, 5}, {Dense{6, activation}, Dense{4, activation}, Dense{3}}}, loss,
                                  "loss " + std::to_string(static_cast<int>(loss)) + " activation " +
                                      std::to_string(static_cast<int>(activation)));
    }
  }
}

TEST(Backward, IsTheSlopeThroughConvolutionsAndPools) {
  for (const Activation activation : kActivations) {
    ExpectGradientOfDifferences({{2, 25},
                                 {Convolution{3, 4, 1, activation}, MaxPool{3, 2},
                                  Convolution{4, 3, 2, activation}, GlobalAveragePool{}, Dense{2}}},
                                Loss::kMse, "activation " + std::to_string(static_cast<int>(activation)));
    ExpectGradientOfDifferences(
        {{1, 19}, {MaxPool{2, 3}, Convolution{2, 2, 1, activation}, Dense{3, activation}}}, Loss::kMape,
        "pool first");
  }
}

TEST(LossShare, IsTheMeanOfItsDefinition) {
  const Matrix<double> p = (Matrix<double>(2, 2) << 1.0, 4.0, -2.0, 0.5).finished();
  const Matrix<double> y = (Matrix<double>(2, 2) << 2.0, 5.0, -4.0, 0.25).finished();
  EXPECT_DOUBLE_EQ(LossShare<double>(Loss::kMape, p, y, 2, nullptr), 25.0 * (0.5 + 0.2 + 0.5 + 1.0));
  EXPECT_DOUBLE_EQ(LossShare<double>(Loss::kMse, p, y, 2, nullptr), 0.25 * (1.0 + 1.0 + 4.0 + 0.0625));
  EXPECT_DOUBLE_EQ(LossShare<double>(Loss::kMae, p, y, 2, nullptr), 0.25 * (1.0 + 1.0 + 2.0 + 0.25));
  const Matrix<double> shares = (Matrix<double>(2, 2) << 1.0, 0.25, 0.0, 0.75).finished();
  const double expected = -0.5 * (1.0 - std::log(std::exp(1.0) + std::exp(-2.0)) + 0.25 * 4.0 + 0.75 * 0.5 -
                                  std::log(std::exp(4.0) + std::exp(0.5)));
  EXPECT_NEAR(LossShare<double>(Loss::kCrossEntropy, p, shares, 2, nullptr), expected, 1e-14);
  // Large values do not overflow.
  EXPECT_NEAR(LossShare<double>(Loss::kCrossEntropy, 1000.0 * p, shares, 2, nullptr), 0.5 * 0.75 * 3500.0,
              1e-9);
}

TEST(DesignOf, HasTheLayersOfThePaper) {  // docs/sources.md#shivam-2023
  const Network ann(DesignOf("ann", 204, 4));
  EXPECT_EQ(ann.parameter_count(), 205 * 500 + 501 * 500 + 501 * 200 + 201 * 100 + 101 * 4);
  const Network cnn(DesignOf("cnn", 204, 4));
  EXPECT_EQ(cnn.parameter_count(), (6 + 1) * 128 + (128 * 3 + 1) * 64 + (64 * 3 + 1) * 64 +
                                       (64 * 3 + 1) * 128 + 129 * 128 + 129 * 4);
  std::vector<Shape> shapes;
  for (const auto& stage : cnn.stages()) shapes.push_back(stage.output);
  EXPECT_EQ(shapes,
            (std::vector<Shape>{
                {128, 199}, {64, 197}, {64, 98}, {64, 96}, {64, 47}, {128, 45}, {128, 1}, {128, 1}, {4, 1}}));
}

TEST(Network, SaysWhatDoesNotFit) {
  EXPECT_EQ(MessageOf([] { DesignOf("rnn", 3, 1); }), "model = 'rnn' is not known (expected ann or cnn)");
  EXPECT_EQ(MessageOf([] { DesignOf("ann", 0, 1); }), "inputs = 0 is not a number from 1 up");
  EXPECT_EQ(MessageOf([] { Network network(DesignOf("cnn", 5, 1)); }),
            "kernel of 6 does not fit into a series of 5 values");
  EXPECT_EQ(MessageOf([] { Network network(DesignOf("cnn", 11, 1)); }),
            "kernel of 3 does not fit into a series of 1 values");
  EXPECT_EQ(MessageOf([] { Network network({{1, 4}, {}}); }), "design has no layers (expected at least one)");
  EXPECT_EQ(MessageOf([] {
              Network network({{1, 4}, {MaxPool{2, 0}}});
            }),
            "stride = 0 is not a number from 1 up");
  const Network network({{1, 4}, {Dense{2}}});
  Pass<double> pass;
  EXPECT_EQ(MessageOf([&] { Forward<double>(network, Vector<double>(9), Matrix<double>(4, 1), pass); }),
            "parameters has 9 values (expected 10)");
  EXPECT_EQ(MessageOf([&] { Forward<double>(network, Vector<double>(10), Matrix<double>(5, 1), pass); }),
            "inputs has 5 rows (expected 4)");
  EXPECT_EQ(MessageOf([] { LossOf("huber"); }),
            "loss = 'huber' is not known (expected mape, mse, mae or cross_entropy)");
  EXPECT_EQ(LossOf("mae"), Loss::kMae);
}

}  // namespace
}  // namespace strainwave::analysis::networks::network_gradient_test
