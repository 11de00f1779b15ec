// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/line_sums.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/terms.h"
#include "analysis/units.h"
#include "tests/analysis/vibration_record.h"
#include "tests/analysis/white_noise.h"

// What fits rest on, against the same by another way: slopes against differences, sums near an order against
// sums at it.
namespace strainwave::analysis::diagnosis::diagnosis_slopes_test {
namespace {

// While the speed rises by a fifth; two records, as the phase of each is a number of its own.
VibrationSamples Samples() {
  const VibrationData record = Record(Turning(1400.0, 0.6, 0.2), 31, Silence);
  return PrepareVibration(std::vector<VibrationData>{record, record});
}

// Largest difference from the central differences of the columns, beside the largest slope.
double FarthestFromDifferences(const VibrationTerm& term) {
  const VibrationSamples samples = Samples();
  const std::vector<VibrationNonlinearParameter> nonlinear_parameters = NonlinearParametersOf(samples, term);
  double farthest = 0.0;
  for (std::size_t run = 0; run < samples.runs.size(); ++run) {
    const Eigen::MatrixXd columns = FillTerm(samples, run, term);
    const Eigen::MatrixXd slopes = FillSlopes(samples, run, term, columns);
    for (std::size_t s = 0; s < nonlinear_parameters.size(); ++s) {
      const double by = 1e-3 * nonlinear_parameters[s].step;
      VibrationTerm above = term;
      VibrationTerm below = term;
      above.nonlinear_parameters[s] += by;
      below.nonlinear_parameters[s] -= by;
      const Eigen::MatrixXd expected =
          (FillTerm(samples, run, above) - FillTerm(samples, run, below)) / (2.0 * by);
      const auto first = static_cast<Eigen::Index>(s) * columns.cols();
      const double off = (slopes.middleCols(first, columns.cols()) - expected).norm();
      farthest = std::max(
          farthest, off / std::max(expected.norm(), 1e-6 * columns.norm() / nonlinear_parameters[s].step));
    }
  }
  return farthest;
}

TEST(FillSlopes, AreThoseOfLines) {
  EXPECT_LT(FarthestFromDifferences({0, VibrationForm::kLines, {{1.0, 0.0}, {3.0, -1.0}}, {5.3}, {1, 1}, {}}),
            1e-4);
  EXPECT_LT(FarthestFromDifferences({0, VibrationForm::kTones, {{1.0, 0.0}}, {211.7}, {1, 1}, {}}), 1e-4);
}

TEST(FillSlopes, AreThoseOfABurst) {
  EXPECT_LT(FarthestFromDifferences({0, VibrationForm::kBurst, {}, {433.0, 0.31, 0.02}, {1, 1}, {}}), 1e-4);
}

// A response begins with a kink: a difference across one sees part of it.
TEST(FillSlopes, AreThoseOfAnImpulseTrain) {
  EXPECT_LT(FarthestFromDifferences(
                {0, VibrationForm::kImpulseTrain, {}, {4.61, 870.0, 0.07, 0.21, -0.34}, {1, 1}, {}}),
            0.01);
  EXPECT_LT(FarthestFromDifferences({0,
                                     VibrationForm::kImpulseTrain,
                                     {{0.0, 1.0}},
                                     {4.61, 870.0, 0.07, 0.4, -0.3, 0.21, -0.34},
                                     {1, 1},
                                     {}}),
            0.01);
  std::vector<double> slips(41);
  for (std::size_t j = 0; j < slips.size(); ++j) slips[j] = 0.03 * std::sin(1.7 * static_cast<double>(j));
  EXPECT_LT(FarthestFromDifferences(
                {0, VibrationForm::kImpulseTrain, {}, {4.61, 870.0, 0.07, 0.21, -0.34}, {1, 1}, slips}),
            0.01);
}

TEST(LineSumsNear, HaveTheDropsOfLinesAtTheirOrders) {
  std::vector<double> angle;
  std::vector<double> residual = WhiteNoise(3000, 0.4, 32);
  std::vector<double> weights;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const double x = static_cast<double>(i) / 3000.0;
    // Forth and back, at uneven steps.
    angle.push_back(0.7 + 40.0 * std::sin(kPi * x) + 0.3 * std::sin(11.0 * x));
    residual[i] += 0.6 + 0.5 * std::cos(9.31 * angle[i] - 0.4);
    weights.push_back(i % 7 == 0 ? 0.0 : 1.0);
  }
  const double reach = 0.5 * kPi / SpanOf(angle);
  const LineSumsNear sums(angle, residual, weights, 9.3, reach);
  for (const double share : {-1.0, -0.4, 0.0, 0.1, 0.7, 1.0}) {
    const double order = 9.3 + share * reach;
    const double expected = LineDrop(angle, residual, weights, order);
    EXPECT_NEAR(sums.Drop(order), expected, 1e-8 * expected);
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_slopes_test
