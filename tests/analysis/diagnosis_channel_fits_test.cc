// SPDX-License-Identifier: Apache-2.0
// Fits of several channels on shared columns: against Eigen's QR decomposition of one channel at a time.
#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <random>
#include <thread>
#include <vector>

#include "analysis/diagnosis/vibration/channel_fits.h"

namespace strainwave::analysis::diagnosis::diagnosis_channel_fits_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Longer than the parts that sums over rows are made of, and no multiple of them.
constexpr Index kSamples = 40'001;
constexpr Index kChannels = 3;

struct ChannelFits : testing::Test {
  ChannelFits() {
    // Columns of very different size.
    for (Index c = 0; c < first.cols(); ++c) first.col(c) *= std::pow(10.0, static_cast<double>(c) - 1.0);
    columns.Add(first);
    columns.Add(second);
  }

  MatrixXd Random(Index rows, Index cols) {
    std::normal_distribution<double> normal;
    return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
  }
  MatrixXd Weights(bool alike) {
    std::bernoulli_distribution kept(0.8);
    MatrixXd weights = MatrixXd::NullaryExpr(kSamples, kChannels, [&] { return kept(random) ? 1.0 : 0.0; });
    if (alike) weights.colwise() = VectorXd(weights.col(0));
    return weights;
  }
  MatrixXd All() const { return columns.Rows(0, kSamples); }
  // Least squares by another route.
  VectorXd Coefficients(const MatrixXd& matrix, const VectorXd& response, const VectorXd& weights) const {
    const VectorXd root = weights.cwiseSqrt();
    return (root.asDiagonal() * matrix).colPivHouseholderQr().solve(root.cwiseProduct(response));
  }

  std::mt19937 random{7};
  MatrixXd first = Random(kSamples, 4);
  MatrixXd second = Random(kSamples, 3);
  MatrixXd responses = Random(kSamples, kChannels);
  SharedColumns columns;
};

void InReverse(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::vector<std::jthread> threads;
  for (std::size_t i = count; i-- > 0;) threads.emplace_back([&task, i] { task(i); });
}

TEST_F(ChannelFits, AreThoseOfEachChannelByItself) {
  for (const bool alike : {true, false}) {
    const MatrixXd weights = Weights(alike);
    const std::vector<ChannelFit> fits = FitChannels(columns, responses, weights, InTurn);
    ASSERT_EQ(fits.size(), 3U);
    for (Index c = 0; c < kChannels; ++c) {
      const ChannelFit& fit = fits[static_cast<std::size_t>(c)];
      const VectorXd expected = Coefficients(All(), responses.col(c), weights.col(c));
      const VectorXd left = responses.col(c) - All() * expected;
      const MatrixXd normal = All().transpose() * weights.col(c).asDiagonal() * All();
      EXPECT_LT((fit.coefficients - expected).cwiseQuotient(expected).cwiseAbs().maxCoeff(), 1e-9);
      EXPECT_LT((fit.residual - left).cwiseAbs().maxCoeff(), 1e-11);
      EXPECT_NEAR(fit.square_sum, weights.col(c).dot(left.cwiseAbs2()), 1e-8);
      EXPECT_TRUE((fit.inverse * normal).isIdentity(1e-8));
    }
  }
}

// Two terms that move, one with two columns, and one between them that does not.
TEST_F(ChannelFits, GaussNewtonStepIsThatOfTheDerivativesWithCoefficientsThatFollow) {
  const MatrixXd weights = Weights(false);
  const std::vector<ChannelFit> fits = FitChannels(columns, responses, weights, InTurn);
  const MatrixXd slopes_of_two = Random(kSamples, 2 * 3);
  const MatrixXd slopes_of_one = Random(kSamples, 1);
  ChannelSlopes slopes{columns, weights, {}, {}};
  for (const ChannelFit& fit : fits) slopes.fits.push_back(&fit);
  slopes.terms = {{&slopes_of_two, 1, 2, 3}, {nullptr, -1, 2, 2}, {&slopes_of_one, 6, 1, 1}};
  ASSERT_EQ(slopes.parameters(), 6);

  SharedStep step(6);
  const std::vector<MatrixXd> follows = AddChannels(slopes, InTurn, step);
  MatrixXd derivatives(kSamples * kChannels, 6);
  const std::vector<MatrixXd> follows_too = ProjectedDerivatives(slopes, InTurn, derivatives);

  MatrixXd normal = MatrixXd::Zero(6, 6);
  VectorXd gradient = VectorXd::Zero(6);
  for (Index c = 0; c < kChannels; ++c) {
    const ChannelFit& fit = fits[static_cast<std::size_t>(c)];
    MatrixXd own = MatrixXd::Zero(kSamples, 6);
    for (Index k = 0; k < 3; ++k)
      own.col(k) = slopes_of_two.middleCols(2 * k, 2) * fit.coefficients.segment(1, 2);
    own.col(5) = slopes_of_one * fit.coefficients(6);
    for (Index s = 0; s < 6; ++s) {
      const VectorXd expected = -Coefficients(All(), own.col(s), weights.col(c));
      EXPECT_TRUE(follows[static_cast<std::size_t>(c)].col(s).isApprox(expected, 1e-8) || expected.isZero());
      own.col(s) += All() * expected;
    }
    EXPECT_TRUE(
        follows[static_cast<std::size_t>(c)].isApprox(follows_too[static_cast<std::size_t>(c)], 1e-10));
    EXPECT_LT((derivatives.middleRows(c * kSamples, kSamples) - own).cwiseAbs().maxCoeff(), 1e-9);
    normal += own.transpose() * weights.col(c).asDiagonal() * own;
    gradient += own.transpose() * weights.col(c).cwiseProduct(fit.residual);
  }
  EXPECT_TRUE(step.normal.isApprox(normal, 1e-9));
  EXPECT_TRUE(step.gradient.isApprox(gradient, 1e-7));

  VectorXd left(kSamples * kChannels);
  for (Index c = 0; c < kChannels; ++c)
    left.segment(c * kSamples, kSamples) = fits[static_cast<std::size_t>(c)].residual;
  const SharedStep followed = StepOfDerivatives(
      derivatives, left, Eigen::Map<const VectorXd>(weights.data(), weights.size()), InTurn);
  EXPECT_TRUE(followed.normal.isApprox(normal, 1e-9));
  EXPECT_TRUE(followed.gradient.isApprox(gradient, 1e-7));
}

TEST_F(ChannelFits, OfFurtherColumnsNeedTheseProducts) {
  const VectorXd root = Weights(true).col(0) * 0.7;
  const MatrixXd further = Random(kSamples, 8);
  const MatrixXd weighted = root.asDiagonal() * further;
  const ProductsOfFurther products = ProductsBeside(further, first, responses, root, InTurn);
  EXPECT_TRUE(products.squares.isApprox(weighted.transpose() * weighted, 1e-12));
  EXPECT_TRUE(products.with_others.isApprox(first.transpose() * weighted, 1e-10));
  EXPECT_TRUE(products.with_residuals.isApprox(weighted.transpose() * responses, 1e-10));
}

TEST_F(ChannelFits, AreTheSameBitsInWhateverOrderThePartsAreDone) {
  const MatrixXd weights = Weights(false);
  const std::vector<ChannelFit> fits = FitChannels(columns, responses, weights, InTurn);
  const std::vector<ChannelFit> others = FitChannels(columns, responses, weights, InReverse);
  for (std::size_t c = 0; c < fits.size(); ++c) {
    EXPECT_EQ(fits[c].coefficients, others[c].coefficients);
    EXPECT_EQ(fits[c].residual, others[c].residual);
    EXPECT_EQ(fits[c].square_sum, others[c].square_sum);
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_channel_fits_test
