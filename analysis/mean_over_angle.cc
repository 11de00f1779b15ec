// SPDX-License-Identifier: Apache-2.0
#include "analysis/mean_over_angle.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <vector>

#include "analysis/angle_weights.h"
#include "analysis/autocorrelation.h"
#include "analysis/units.h"

namespace strainwave::analysis {
namespace {

double Remainder(double angle_rad) {
  const double remainder = std::fmod(angle_rad, kTwoPi);
  return remainder < 0.0 ? remainder + kTwoPi : remainder;
}

// One turn, sorted by angle, with a copy of the first sample a turn later.
class Turn {
 public:
  explicit Turn(const MeasuredCurve& curve) : fit_(curve.fit) {
    for (std::size_t i = 0; i < curve.angle_rad.size(); ++i) {
      points_.push_back({Remainder(curve.angle_rad[i]), curve.angle_rad[i], curve.fit.residuals[i]});
    }
    std::ranges::stable_sort(points_, {}, &Point::remainder_rad);
    std::vector<double> angle_rad;
    for (const Point& point : points_) angle_rad.push_back(point.remainder_rad);
    longest_gap_rad_ = 3.0 * UsualStep(angle_rad);
    points_.push_back(points_.front());
    points_.back().remainder_rad += kTwoPi;
  }

  // None across a gap of more than three usual steps: the sweep was not there.
  std::optional<double> At(double angle_rad) const {
    double remainder_rad = Remainder(angle_rad);
    if (remainder_rad < points_.front().remainder_rad) remainder_rad += kTwoPi;
    auto right = std::ranges::upper_bound(points_, remainder_rad, {}, &Point::remainder_rad);
    if (right == points_.end()) --right;
    const Point& left = *std::prev(right);
    const double gap_rad = right->remainder_rad - left.remainder_rad;
    if (gap_rad > longest_gap_rad_) return std::nullopt;
    const double beyond_rad = remainder_rad - left.remainder_rad;
    const double share = gap_rad > 0.0 ? beyond_rad / gap_rad : 0.0;
    return HarmonicValue(fit_, left.angle_rad + beyond_rad) +
           std::lerp(left.residual, right->residual, share);
  }

 private:
  struct Point {
    double remainder_rad{};
    double angle_rad{};  // in the turn in which it was measured: orders need not be whole numbers
    double residual{};
  };
  const HarmonicFit& fit_;
  std::vector<Point> points_;
  double longest_gap_rad_{};
};

struct Sum {
  double total{};
  double weight{};
};

Sum DifferencesAtAngles(const MeasuredCurve& at, const MeasuredCurve& other) {
  const Turn turn(other);
  const std::vector<double> weights = AngleWeights(at.angle_rad);
  Sum sum;
  for (std::size_t i = 0; i < at.angle_rad.size(); ++i) {
    if (const auto there = turn.At(at.angle_rad[i])) {
      sum.total += weights[i] * (HarmonicValue(at.fit, at.angle_rad[i]) + at.fit.residuals[i] - *there);
      sum.weight += weights[i];
    }
  }
  return sum;
}

}  // namespace

Estimate MeanOverAngle(const MeasuredCurve& curve) {
  const std::vector<double> weights = AngleWeights(curve.angle_rad);
  const double begin_rad = curve.angle_rad.front();
  const double end_rad = begin_rad + WeightedAngle(curve.angle_rad);
  double mean = curve.fit.constant.value;
  double squares = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    mean += weights[i] * curve.fit.residuals[i];
    squares += weights[i] * weights[i];
  }
  double variance = squares * VarianceInflation(curve.fit.residuals) * curve.fit.residual_standard_deviation *
                    curve.fit.residual_standard_deviation;
  for (const Harmonic& harmonic : curve.fit.harmonics) {
    const double order = harmonic.order;
    const auto wave = [&](double angle_rad) {
      return std::polar(1.0, order * angle_rad - harmonic.phase_rad.value);
    };
    const std::complex<double> integral =
        (wave(end_rad) - wave(begin_rad)) / std::complex(0.0, order * (end_rad - begin_rad));
    std::complex<double> of_samples;
    std::complex<double> of_squares;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const std::complex<double> at = wave(curve.angle_rad[i]);
      of_samples += weights[i] * at;
      of_squares += weights[i] * at * at;
    }
    // Of a wave of two samples a period they see one phase: what the fit says of the other is void.
    constexpr double kOnePhase = 0.9;
    if (std::abs(of_squares) > kOnePhase) {
      mean += harmonic.amplitude.value * of_samples.real();
      continue;
    }
    mean += harmonic.amplitude.value * integral.real();
    variance += std::norm(harmonic.amplitude.standard_error * (integral - of_samples));
  }
  return {mean, std::sqrt(variance)};
}

std::optional<double> MeanDifferenceAtEqualAngle(const MeasuredCurve& first, const MeasuredCurve& second) {
  const Sum forward = DifferencesAtAngles(first, second);
  const Sum backward = DifferencesAtAngles(second, first);
  if (!(forward.weight > 0.0) || !(backward.weight > 0.0)) {
    return std::nullopt;
  }
  return 0.5 * (forward.total / forward.weight - backward.total / backward.weight);
}

}  // namespace strainwave::analysis
