// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/residual_tests.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <vector>

#include "analysis/diagnosis/noise_likelihood.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kFewestSamples = 10;

std::vector<std::size_t> SegmentOf(std::size_t samples, std::span<const std::size_t> segments) {
  std::vector<std::size_t> segment_of(samples, 0);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const std::size_t end = s + 1 < segments.size() ? segments[s + 1] : samples;
    for (std::size_t i = segments[s]; i < end; ++i) {
      segment_of[i] = s;
    }
  }
  return segment_of;
}

double TwoSidedNormal(double z) {
  return 2.0 * boost::math::cdf(boost::math::complement(boost::math::normal(), std::abs(z)));
}

struct Filtered {
  std::vector<double> residual;
  std::vector<double> regressor;
  std::vector<char> valid;
};

// Both through the autoregressive filter of the residual, centred; a sample whose lags are not all there is
// not valid.
Filtered FilterBoth(std::span<const double> residual, std::span<const double> regressor,
                    std::span<const double> weights, std::span<const std::size_t> segments,
                    std::span<const std::size_t> segment_of) {
  constexpr int kLargestOrder = 8;
  const std::size_t n = residual.size();
  const NoiseFit noise = FitNoise(residual, weights, segments, kLargestOrder, 0.0);
  const auto order = static_cast<std::size_t>(noise.order);
  Filtered out{std::vector<double>(n), std::vector<double>(n), std::vector<char>(n, 0)};
  double count = 0.0;
  double residual_sum = 0.0;
  double regressor_sum = 0.0;
  for (std::size_t i = order; i < n; ++i) {
    bool valid = weights[i] > 0.0;
    double e = residual[i];
    double x = regressor[i];
    for (std::size_t k = 1; k <= order; ++k) {
      valid = valid && weights[i - k] > 0.0 && segment_of[i - k] == segment_of[i];
      e -= noise.series.front().coefficients[k - 1] * residual[i - k];
      x -= noise.series.front().coefficients[k - 1] * regressor[i - k];
    }
    if (!valid) continue;
    out.valid[i] = 1;
    out.residual[i] = e;
    out.regressor[i] = x;
    count += 1.0;
    residual_sum += e;
    regressor_sum += x;
  }
  for (std::size_t i = 0; i < n && count > 0.0; ++i) {
    if (out.valid[i] == 0) continue;
    out.residual[i] -= residual_sum / count;
    out.regressor[i] -= regressor_sum / count;
  }
  return out;
}

struct PairSums {
  double product{}, later_square{}, earlier_square{};
  std::size_t pairs{};

  double Correlation() const {
    const double scale = std::sqrt(later_square * earlier_square);
    return scale > 0.0 ? product / scale : 0.0;
  }
};

// Of later[i] with earlier[i − lag] where both are valid and in one segment.
PairSums Lagged(std::span<const double> later, std::span<const double> earlier, std::span<const char> valid,
                std::span<const std::size_t> segment_of, std::ptrdiff_t lag) {
  PairSums sums;
  const auto n = static_cast<std::ptrdiff_t>(later.size());
  for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, lag); i < std::min(n, n + lag); ++i) {
    const auto a = static_cast<std::size_t>(i);
    const auto b = static_cast<std::size_t>(i - lag);
    if (valid[a] == 0 || valid[b] == 0 || segment_of[a] != segment_of[b]) continue;
    sums.product += later[a] * earlier[b];
    sums.later_square += later[a] * later[a];
    sums.earlier_square += earlier[b] * earlier[b];
    ++sums.pairs;
  }
  return sums;
}

// Probability that the largest of `count` standard normal magnitudes reaches t, neighbours correlated by rho.
double LargestOfChain(double t, double rho, int count) {
  const double single = TwoSidedNormal(t);
  if (count < 2 || !(single < 1.0)) return single;
  rho = std::clamp(std::abs(rho), 0.0, 0.999999);
  const double spread = std::sqrt(1.0 - rho * rho);
  const boost::math::normal normal;
  const auto next_exceeds = [&](double z) {
    return boost::math::pdf(normal, z) *
           (boost::math::cdf(boost::math::complement(normal, (t - rho * z) / spread)) +
            boost::math::cdf(boost::math::complement(normal, (t + rho * z) / spread)));
  };
  const double joint =
      2.0 * boost::math::quadrature::gauss_kronrod<double, 31>::integrate(next_exceeds, 0.0, t, 12, 1e-7);
  const double step = std::min(joint / (1.0 - single), 1.0);
  return -std::expm1(std::log1p(-single) + static_cast<double>(count - 1) * std::log1p(-step));
}

}  // namespace

double LjungBoxP(std::span<const double> residual, std::span<const double> weights,
                 std::span<const std::size_t> segments, int noise_order) {
  const std::size_t n = residual.size();
  std::vector<double> x(n);
  std::vector<char> valid(n);
  double count = 0.0;
  double square_sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = residual[i] * std::sqrt(std::max(0.0, weights[i]));
    valid[i] = weights[i] > 0.0 ? 1 : 0;
    count += valid[i] != 0 ? 1.0 : 0.0;
    square_sum += x[i] * x[i];
  }
  if (count < static_cast<double>(kFewestSamples) || !(square_sum > 0.0)) return 1.0;
  const std::vector<std::size_t> segment_of = SegmentOf(n, segments);
  const int lags = std::min(20, static_cast<int>(count) / 5);
  double statistic = 0.0;
  int used = 0;
  for (int lag = 1; lag <= lags; ++lag) {
    const PairSums sums = Lagged(x, x, valid, segment_of, lag);
    if (sums.pairs == 0) continue;
    // With all pairs there, n (n + 2) r² / (n − lag).
    const double r = sums.product / square_sum;
    statistic += count * (count + 2.0) * r * r / static_cast<double>(sums.pairs);
    ++used;
  }
  const int freedom = used - noise_order;
  if (freedom < 1) return 1.0;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(freedom), statistic));
}

double RunsP(std::span<const double> residual, std::span<const double> weights,
             std::span<const std::size_t> segments) {
  const std::vector<std::size_t> segment_of = SegmentOf(residual.size(), segments);
  double positive = 0.0;
  double negative = 0.0;
  double pairs = 0.0;    // of neighbours
  double shared = 0.0;   // pairs of pairs that share a sample
  double changes = 0.0;  // pairs of different sign
  bool pair_before = false;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const auto counts = [&](std::size_t k) { return weights[k] > 0.0 && residual[k] != 0.0; };
    if (!counts(i)) {
      pair_before = false;
      continue;
    }
    (residual[i] > 0.0 ? positive : negative) += 1.0;
    const bool pair = i > 0 && counts(i - 1) && segment_of[i - 1] == segment_of[i];
    if (pair) {
      pairs += 1.0;
      shared += pair_before ? 1.0 : 0.0;
      changes += (residual[i] > 0.0) != (residual[i - 1] > 0.0) ? 1.0 : 0.0;
    }
    pair_before = pair;
  }
  const double n = positive + negative;
  if (n < static_cast<double>(kFewestSamples) || positive == 0.0 || negative == 0.0 || pairs == 0.0)
    return 1.0;
  const double ab = positive * negative;
  const double one = 2.0 * ab / (n * (n - 1.0));  // a pair differs
  const double two = 4.0 * ab * (positive - 1.0) * (negative - 1.0) /
                     (n * (n - 1.0) * (n - 2.0) * (n - 3.0));  // two pairs apart both differ
  // Two pairs that share their middle sample both differ with half the probability that one of them does.
  const double variance =
      pairs * one + shared * one + (pairs * (pairs - 1.0) - 2.0 * shared) * two - pairs * pairs * one * one;
  if (!(variance > 0.0)) return 1.0;
  return TwoSidedNormal((changes - pairs * one) / std::sqrt(variance));
}

CrossCorrelation LargestCrossCorrelation(std::span<const double> residual, std::span<const double> regressor,
                                         std::span<const double> weights,
                                         std::span<const std::size_t> segments, int largest_lag) {
  const std::vector<std::size_t> segment_of = SegmentOf(residual.size(), segments);
  const Filtered both = FilterBoth(residual, regressor, weights, segments, segment_of);
  CrossCorrelation best;
  double largest = -1.0;
  int lags = 0;
  for (std::ptrdiff_t lag = -largest_lag; lag <= largest_lag; ++lag) {
    const PairSums sums = Lagged(both.residual, both.regressor, both.valid, segment_of, lag);
    if (sums.pairs < kFewestSamples) continue;
    ++lags;
    const double r = sums.Correlation();
    const double freedom = static_cast<double>(sums.pairs) - 2.0;
    // The normal deviate with the tail that Student's t has, so that short and long lags compare.
    const double t = std::abs(r) * std::sqrt(freedom / std::max(1e-300, 1.0 - r * r));
    const double tail =
        boost::math::cdf(boost::math::complement(boost::math::students_t(freedom), std::min(t, 1e6)));
    const double z =
        boost::math::quantile(boost::math::complement(boost::math::normal(), std::clamp(tail, 1e-300, 0.5)));
    if (z > largest) {
      largest = z;
      best.coefficient = r;
      best.lag = lag;
    }
  }
  if (lags == 0) return best;
  const double neighbours = Lagged(both.regressor, both.regressor, both.valid, segment_of, 1).Correlation();
  best.p_value = std::clamp(LargestOfChain(largest, neighbours, lags), 0.0, 1.0);
  return best;
}

double CrossCorrelationP(std::span<const double> residual, std::span<const double> regressor,
                         std::span<const double> weights, std::span<const std::size_t> segments,
                         int largest_lag) {
  return LargestCrossCorrelation(residual, regressor, weights, segments, largest_lag).p_value;
}

}  // namespace strainwave::analysis::diagnosis
