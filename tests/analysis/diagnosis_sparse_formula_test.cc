// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/sparse_formula.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <regex>
#include <string>
#include <vector>

#include "tests/analysis/plain_study.h"

namespace strainwave::analysis::diagnosis::diagnosis_sparse_formula_test {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kArcminPerRad = 360.0 * 60.0 / kTurn;

// Three turns of the output, one of them back, while it warms up; SI inside, arcmin and degrees outside.
PlainRecord ThreeTurns(std::size_t samples) {
  PlainRecord record;
  Regressor angle{"output_angle", "output angle / deg", 360.0 / kTurn, {}, true};
  Regressor direction{"direction", "direction", 1.0, {}, false};
  Regressor torque{"torque", "torque / Nm", 1.0, {}, false};
  Regressor temperature{"temperature", "temperature / degC", 1.0, {}, false};
  for (std::size_t i = 0; i < samples; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(samples);
    angle.values.push_back(share < 2.0 / 3.0 ? 3.0 * kTurn * share
                                             : 2.0 * kTurn - 3.0 * kTurn * (share - 2.0 / 3.0));
    direction.values.push_back(share < 2.0 / 3.0 ? 1.0 : -1.0);
    torque.values.push_back(20.0 * std::sin(11.3 * kTurn * share));
    temperature.values.push_back(25.0 + 4.0 * (1.0 - std::exp(-3.0 * share)));
  }
  record.regressors = {angle, direction, torque, temperature};
  record.unit = "arcmin";
  record.unit_per_si = kArcminPerRad;
  record.block_length = samples / 30;
  return record;
}

std::vector<double> Noise(unsigned seed, std::size_t samples, double rho) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> x(samples);
  double last = 0.0;
  for (int i = 0; i < 100; ++i) last = rho * last + normal(engine);
  for (double& value : x) {
    last = rho * last + normal(engine);
    value = 0.1 * last * std::sqrt(1.0 - rho * rho) / kArcminPerRad;  // 0.1 arcmin
  }
  return x;
}

SparseFormula Propose(PlainRecord record, const std::vector<double>& residual, unsigned long long seed = 7) {
  record.measured = residual;
  const PlainStudy study = MakePlainStudy(std::move(record));
  return ProposeFormula(
      *study, Eigen::Map<const Eigen::VectorXd>(residual.data(), static_cast<Eigen::Index>(residual.size())),
      std::vector<double>(residual.size(), 1.0), seed);
}

TEST(ProposeFormula, HasNothingToSayAboutNoise) {
  int spoken = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const double rho = seed % 3 == 0 ? 0.7 : 0.0;
    spoken += Propose(ThreeTurns(900), Noise(seed, 900, rho)).formula.empty() ? 0 : 1;
  }
  EXPECT_LE(spoken, 1);
}

TEST(ProposeFormula, WritesALineInTheUnitsOfTheEdge) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const PlainRecord record = ThreeTurns(900);
    auto residual = Noise(seed, 900, 0.0);
    double variance = 0.0;
    for (std::size_t i = 0; i < residual.size(); ++i) {
      const double hidden =
          0.1 / kArcminPerRad * std::cos(7.0 * record.regressors[0].values[i] - 35.0 * kTurn / 360.0);
      residual[i] += hidden;
      variance += hidden * hidden;
    }
    double all = 0.0;
    for (const double value : residual) all += value * value;
    const SparseFormula proposed = Propose(record, residual);
    std::smatch match;
    const std::regex expected(
        R"(residual / arcmin = (0\.\d+) cos\((\S+) output_angle - (\d+) deg\)( [+-] 0\.0\d+)?)");
    ASSERT_TRUE(std::regex_match(proposed.formula, match, expected)) << seed << ": " << proposed.formula;
    // Amplitude to 0.1 · √(2 / 900), four times that.
    EXPECT_NEAR(std::stod(match[1]), 0.1, 0.02) << proposed.formula;
    EXPECT_NEAR(std::stod(match[2]), 7.0, 0.05) << proposed.formula;
    EXPECT_NEAR(std::stod(match[3]), 35.0, 20.0) << proposed.formula;
    EXPECT_NEAR(proposed.heldout_share, variance / all, 0.1);
    EXPECT_NE(proposed.sentence.find("says nothing about the physical cause"), std::string::npos);
  }
}

TEST(ProposeFormula, FindsAProductWithTheDirectionAndLeavesTheRestOut) {
  int exact = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const PlainRecord record = ThreeTurns(900);
    auto residual = Noise(seed, 900, 0.0);
    for (std::size_t i = 0; i < residual.size(); ++i) {
      residual[i] +=
          0.008 / kArcminPerRad * record.regressors[1].values[i] * std::abs(record.regressors[2].values[i]);
    }
    const SparseFormula proposed = Propose(record, residual);
    exact += proposed.formula.find("direction abs(torque)") != std::string::npos ? 1 : 0;
    EXPECT_EQ(proposed.formula.find("cos"), std::string::npos) << proposed.formula;
  }
  EXPECT_GE(exact, 9);
}

TEST(ProposeFormula, FindsASquareBelowColouredNoise) {
  int found = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const PlainRecord record = ThreeTurns(1500);
    auto residual = Noise(seed, 1500, 0.6);
    for (std::size_t i = 0; i < residual.size(); ++i) {
      const double torque = record.regressors[2].values[i];
      residual[i] += 0.0006 / kArcminPerRad * torque * torque;
    }
    const std::string formula = Propose(record, residual).formula;
    found +=
        formula.find("^2") != std::string::npos || formula.find("abs(torque)") != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(found, 9);
}

TEST(ProposeFormula, GivesTheSameFormulaForTheSameSeed) {
  const PlainRecord record = ThreeTurns(900);
  auto residual = Noise(3, 900, 0.0);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    residual[i] += 0.08 / kArcminPerRad * std::sin(2.0 * record.regressors[0].values[i]);
  }
  const SparseFormula first = Propose(record, residual, 11);
  const SparseFormula second = Propose(record, residual, 11);
  EXPECT_FALSE(first.formula.empty());
  EXPECT_EQ(first.formula, second.formula);
  EXPECT_EQ(first.heldout_share, second.heldout_share);
}

TEST(ProposeFormula, KeepsSilentBelowAHundredSamples) {
  PlainRecord record = ThreeTurns(90);
  std::vector<double> residual(90);
  for (std::size_t i = 0; i < 90; ++i) residual[i] = std::cos(record.regressors[0].values[i]);
  EXPECT_TRUE(Propose(record, residual).formula.empty());
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_sparse_formula_test
