// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/residual_tests.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/analysis/plain_study.h"

namespace strainwave::analysis::diagnosis::diagnosis_residual_tests_test {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::size_t kOneSegment[] = {0};

struct Noise {
  std::mt19937 engine;
  std::normal_distribution<double> normal;

  explicit Noise(unsigned seed) : engine(seed) {}
  std::vector<double> White(std::size_t n) {
    std::vector<double> x(n);
    for (double& value : x) value = normal(engine);
    return x;
  }
  // Started far enough back to have forgotten its start.
  std::vector<double> Autoregressive(std::size_t n, double rho) {
    std::vector<double> x(n);
    double last = 0.0;
    for (int i = 0; i < 200; ++i) last = rho * last + normal(engine);
    for (double& value : x) value = last = rho * last + normal(engine);
    return x;
  }
};

std::vector<double> Ones(std::size_t n) { return std::vector<double>(n, 1.0); }

// Shares of p-values below one and five per cent.
struct Shares {
  double one{}, five{};
  template <typename P>
  static Shares Of(int trials_factor, P p_of_seed) {
    Shares shares;
    for (int seed = 1; seed <= trials_factor; ++seed) {
      const double p = p_of_seed(static_cast<unsigned>(seed));
      shares.one += p < 0.01 ? 1.0 / trials_factor : 0.0;
      shares.five += p < 0.05 ? 1.0 / trials_factor : 0.0;
    }
    return shares;
  }
};

void ExpectNominal(const Shares& shares) {
  // Four standard errors of 2000 trials are 0.02 and 0.009.
  EXPECT_GT(shares.five, 0.03);
  EXPECT_LT(shares.five, 0.07);
  EXPECT_GT(shares.one, 0.002);
  EXPECT_LT(shares.one, 0.02);
}

TEST(LjungBoxP, IsUniformForWhiteNoise) {
  ExpectNominal(Shares::Of(2000, [](unsigned seed) {
    const auto x = Noise(seed).White(300);
    return LjungBoxP(x, Ones(300), kOneSegment, 0);
  }));
}

TEST(LjungBoxP, IsUniformWithGapsAndManySegments) {
  ExpectNominal(Shares::Of(2000, [](unsigned seed) {
    Noise noise(seed);
    const auto x = noise.White(400);
    std::vector<double> weights = Ones(400);
    for (double& weight : weights) weight = noise.normal(noise.engine) > 1.0 ? 0.0 : 1.0;
    const std::size_t segments[] = {0, 90, 100, 250};
    return LjungBoxP(x, weights, segments, 0);
  }));
}

TEST(LjungBoxP, SeesAWeakAutocorrelationThatASegmentStartInterrupts) {
  const Shares shares = Shares::Of(200, [](unsigned seed) {
    const auto x = Noise(seed).Autoregressive(600, 0.3);
    const std::size_t segments[] = {0, 300};
    return LjungBoxP(x, Ones(600), segments, 0);
  });
  EXPECT_GT(shares.one, 0.98);
}

TEST(LjungBoxP, DoesNotJoinSegments) {
  // Levels that differ from segment to segment of two samples: neighbours across the border would not agree.
  std::vector<double> x;
  std::vector<std::size_t> segments;
  for (std::size_t i = 0; i < 100; ++i) {
    segments.push_back(x.size());
    x.push_back(i % 2 == 0 ? 1.0 : -1.0);
  }
  EXPECT_EQ(LjungBoxP(x, Ones(x.size()), segments, 0), 1.0);
  EXPECT_LT(LjungBoxP(x, Ones(x.size()), kOneSegment, 0), 1e-10);
}

TEST(LjungBoxP, AgreesWithTheFormulaByHand) {
  // Ten samples, two lags: Q = 10 · 12 (r₁²/9 + r₂²/8), and with two degrees of freedom p = exp(−Q/2).
  const std::vector<double> x{1.0, -0.5, 0.3, 0.8, -1.2, 0.4, 0.1, -0.9, 0.6, 0.2};
  double r0 = 0.0, r1 = 0.0, r2 = 0.0;
  for (std::size_t i = 0; i < 10; ++i) {
    r0 += x[i] * x[i];
    if (i >= 1) r1 += x[i] * x[i - 1];
    if (i >= 2) r2 += x[i] * x[i - 2];
  }
  const double q = 120.0 * (r1 * r1 / 9.0 + r2 * r2 / 8.0) / (r0 * r0);
  EXPECT_NEAR(LjungBoxP(x, Ones(10), kOneSegment, 0), std::exp(-0.5 * q), 1e-12);
  // One degree less for a fitted first-order model: twice the normal tail of √Q.
  EXPECT_NEAR(LjungBoxP(x, Ones(10), kOneSegment, 1), std::erfc(std::sqrt(0.5 * q)), 1e-12);
}

TEST(RunsP, IsUniformForWhiteNoise) {
  ExpectNominal(Shares::Of(2000, [](unsigned seed) {
    const auto x = Noise(seed).White(500);
    return RunsP(x, Ones(500), kOneSegment);
  }));
}

TEST(RunsP, IsUniformWithGapsAndManySegments) {
  ExpectNominal(Shares::Of(2000, [](unsigned seed) {
    Noise noise(seed);
    const auto x = noise.White(600);
    std::vector<double> weights = Ones(600);
    for (double& weight : weights) weight = noise.normal(noise.engine) > 0.5 ? 0.0 : 1.0;
    const std::size_t segments[] = {0, 37, 200};
    return RunsP(x, weights, segments);
  }));
}

TEST(RunsP, HasTheClassicalMomentsWithoutGaps) {
  // Six of each sign in two runs: mean 1 + 2ab/n = 7, variance 2ab(2ab − n)/(n²(n − 1)) = 2.7272….
  const std::vector<double> x{1, 2, 3, 1, 2, 1, -1, -2, -1, -3, -1, -2};
  const double z = (2.0 - 7.0) / std::sqrt(72.0 * 60.0 / (144.0 * 11.0));
  EXPECT_NEAR(RunsP(x, Ones(12), kOneSegment), std::erfc(std::abs(z) / std::sqrt(2.0)), 1e-12);
}

TEST(RunsP, SeesASlowWaveBelowHeavyTails) {
  const Shares shares = Shares::Of(200, [](unsigned seed) {
    std::mt19937 engine(seed);
    std::student_t_distribution<double> heavy(1.5);
    std::vector<double> x(600);
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] = heavy(engine) + std::sin(kTurn * static_cast<double>(i) / 200.0);
    }
    return RunsP(x, Ones(600), kOneSegment);
  });
  EXPECT_GT(shares.one, 0.85);
}

TEST(CrossCorrelationP, IsUniformForTwoWhiteSeries) {
  ExpectNominal(Shares::Of(2000, [](unsigned seed) {
    Noise noise(seed);
    const auto x = noise.White(400);
    const auto u = noise.White(400);
    return CrossCorrelationP(x, u, Ones(400), kOneSegment, 10);
  }));
}

TEST(CrossCorrelationP, IsNoLargerThanItSaysForTwoSlowSeries) {
  const Shares shares = Shares::Of(2000, [](unsigned seed) {
    Noise noise(seed);
    const auto x = noise.Autoregressive(500, 0.9);
    const auto u = noise.Autoregressive(500, 0.9);
    return CrossCorrelationP(x, u, Ones(500), kOneSegment, 10);
  });
  ExpectNominal(shares);
}

TEST(CrossCorrelationP, FindsTheDelayAtWhichTheResidualFollows) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Noise noise(seed);
    const auto u = noise.Autoregressive(600, 0.5);
    auto x = noise.Autoregressive(600, 0.7);
    for (std::size_t i = 4; i < x.size(); ++i) x[i] += 0.5 * u[i - 4];
    const CrossCorrelation found = LargestCrossCorrelation(x, u, Ones(600), kOneSegment, 10);
    EXPECT_LT(found.p_value, 1e-6);
    EXPECT_EQ(found.lag, 4) << "seed " << seed;
    EXPECT_GT(found.coefficient, 0.2);
  }
}

// A sweep of 720 samples, one turn each way in 0.5° steps.
PlainRecord Sweep(double step_deg, std::size_t steps) {
  PlainRecord record;
  Regressor angle{"output_angle", "output angle / deg", 360.0 / kTurn, {}, true};
  Regressor direction{"direction", "direction", 1.0, {}, false};
  Regressor temperature{"temperature", "temperature / degC", 1.0, {}, false};
  Regressor time{"time", "time / s", 1.0, {}, false};
  for (std::size_t i = 0; i < 2 * steps; ++i) {
    const std::size_t place = i < steps ? i : 2 * steps - 1 - i;
    angle.values.push_back(static_cast<double>(place) * step_deg * kTurn / 360.0);
    direction.values.push_back(i < steps ? 1.0 : -1.0);
    temperature.values.push_back(25.0 + 3.0 * (1.0 - std::exp(-static_cast<double>(i) / 300.0)));
    time.values.push_back(2.0 * static_cast<double>(i));
  }
  record.regressors = {angle, direction, temperature, time};
  record.segments = {0, steps};
  return record;
}

std::string Described(PlainRecord record, const std::vector<double>& residual) {
  record.measured = residual;
  record.unit = "arcmin";
  record.unit_per_si = 1.0;
  const PlainStudy study = MakePlainStudy(std::move(record));
  return DescribeResidual(
      *study, Eigen::Map<const Eigen::VectorXd>(residual.data(), static_cast<Eigen::Index>(residual.size())),
      Ones(residual.size()));
}

TEST(DescribeResidual, SaysNothingAboutNoise) {
  int spoken = 0;
  constexpr int kSeeds = 400;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Noise noise(seed);
    const auto residual = seed % 2 == 0 ? noise.White(720) : noise.Autoregressive(720, 0.8);
    spoken += Described(Sweep(1.0, 360), residual).empty() ? 0 : 1;
  }
  // One in a thousand by its own rule; two more than that of 400 by chance is less than one in fifty.
  EXPECT_LE(spoken, 3);
}

TEST(DescribeResidual, NamesALineWithTheOrdersThatFoldOntoIt) {
  const PlainRecord record = Sweep(1.0, 360);
  auto residual = Noise(3).White(720);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    residual[i] += 0.8 * std::cos(320.0 * record.regressors[0].values[i] - 0.4);
  }
  EXPECT_NE(Described(record, residual).find("line at 40.0"), std::string::npos)
      << Described(record, residual);
  EXPECT_NE(Described(record, residual).find("per output turn"), std::string::npos);
  EXPECT_NE(Described(record, residual).find("(1 deg steps: also 320"), std::string::npos);
}

TEST(DescribeResidual, FindsALineAWindowAndADriftByTheirNumbers) {
  int lines = 0;
  int windows = 0;
  int drifts = 0;
  int directions = 0;
  constexpr int kSeeds = 40;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const PlainRecord record = Sweep(1.0, 360);
    const auto noise = Noise(seed).White(720);
    auto line = noise;
    auto window = noise;
    auto drift = noise;
    auto direction = noise;
    for (std::size_t i = 0; i < noise.size(); ++i) {
      const double angle = record.regressors[0].values[i];
      line[i] += 0.45 * std::cos(7.0 * angle + 1.0);
      window[i] += std::abs(angle * 360.0 / kTurn - 121.0) < 6.0 ? 2.0 : 0.0;
      drift[i] += 0.5 * (record.regressors[2].values[i] - 27.0);
      direction[i] += 0.3 * record.regressors[1].values[i];
    }
    lines += Described(record, line).starts_with("line at 7.0") ||
             Described(record, line).starts_with("line at 6.9");
    windows += Described(record, window).starts_with("window from 11");
    drifts += Described(record, drift).find("rises with t") == 0;
    directions += Described(record, direction).starts_with("rises with direction");
    if (seed == 1) {
      ::testing::Test::RecordProperty("said_of_line", Described(record, line));
      ::testing::Test::RecordProperty("window", Described(record, window));
      ::testing::Test::RecordProperty("drift", Described(record, drift));
      ::testing::Test::RecordProperty("direction", Described(record, direction));
    }
  }
  EXPECT_GE(lines, kSeeds - 1);
  EXPECT_GE(windows, kSeeds - 1);
  EXPECT_GE(drifts, kSeeds - 1);
  EXPECT_GE(directions, kSeeds - 1);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_residual_tests_test
