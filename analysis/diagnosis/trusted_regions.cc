// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/trusted_regions.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "analysis/arguments.h"
#include "analysis/autocorrelation.h"
#include "analysis/diagnosis/residual_views.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kFewestRanges = 3;
constexpr std::size_t kMostRanges = 12;
constexpr std::size_t kFewestSectors = 6;
constexpr std::size_t kMostSectors = 24;
constexpr double kIndependentSamples =
    40.0;  // in a range on average: most have the 24 that show that it holds
// Values that differ by less count as one: steps that rounding has made uneven.
constexpr double kSameValue = 5e-4;  // of the span
constexpr double kOutsideUpperBound = 0.05;

// Squared noise as a series: its mean, and for how many independent squares one of them counts.
struct SquaredNoise {
  double mean{};
  double degrees_of_freedom_per_sample{};
};

SquaredNoise SquaredNoiseOf(std::span<const double> noise, std::span<const double> weights, double floor) {
  std::vector<double> squares;
  for (std::size_t i = 0; i < noise.size(); ++i)
    if (weights[i] > 0.0) squares.push_back(weights[i] * noise[i] * noise[i]);
  const auto count = static_cast<double>(squares.size());
  const double mean = std::accumulate(squares.begin(), squares.end(), 0.0) / std::max(1.0, count);
  double variance = 0.0;
  for (double& square : squares) {
    square -= mean;
    variance += square * square / std::max(1.0, count);
  }
  const double inflation = squares.size() > 1 ? VarianceInflation(squares) : 1.0;
  SquaredNoise of{std::max(mean, floor * floor), 1.0};
  // χ²(ν)/ν · mean has variance 2 mean²/ν; no noise has squares that vary less than the normal one's.
  if (variance > 0.0)
    of.degrees_of_freedom_per_sample = std::min(1.0, 2.0 * mean * mean / (variance * inflation));
  return of;
}

// Samples of one range.
struct Range {
  double low{std::numeric_limits<double>::infinity()};
  double high{-std::numeric_limits<double>::infinity()};
  std::vector<std::size_t> samples;
};

std::vector<Range> OfEqualWidth(std::span<const double> values, std::span<const double> weights, double low,
                                double high, std::size_t count) {
  std::vector<Range> ranges(count);
  const double width = (high - low) / static_cast<double>(count);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(weights[i] > 0.0) || !std::isfinite(values[i])) continue;
    const auto index =
        std::min(count - 1, static_cast<std::size_t>(std::max(0.0, (values[i] - low) / width)));
    ranges[index].samples.push_back(i);
  }
  for (std::size_t k = 0; k < count; ++k) {
    ranges[k].low = low + width * static_cast<double>(k);
    ranges[k].high = low + width * static_cast<double>(k + 1);
  }
  return ranges;
}

// Empty where there are more than kMostRanges values.
std::vector<Range> OfFewValues(std::span<const double> values, std::span<const double> weights, double low,
                               double span) {
  const auto place = [&](std::size_t i) { return std::lround((values[i] - low) / (span * kSameValue)); };
  std::set<long> places;
  for (std::size_t i = 0; i < values.size() && places.size() <= kMostRanges; ++i)
    if (weights[i] > 0.0 && std::isfinite(values[i])) places.insert(place(i));
  if (places.size() > kMostRanges) return {};
  std::vector<Range> ranges(places.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(weights[i] > 0.0) || !std::isfinite(values[i])) continue;
    Range& range = ranges[static_cast<std::size_t>(std::distance(places.begin(), places.find(place(i))))];
    range.low = std::min(range.low, values[i]);
    range.high = std::max(range.high, values[i]);
    range.samples.push_back(i);
  }
  for (Range& range : ranges) range.low = range.high = 0.5 * (range.low + range.high);
  return ranges;
}

std::vector<Range> RangesOf(const Regressor& regressor, std::span<const double> weights,
                            double independent_samples) {
  const auto count = [&](std::size_t fewest, std::size_t most) {
    return static_cast<std::size_t>(std::clamp(independent_samples / kIndependentSamples,
                                               static_cast<double>(fewest), static_cast<double>(most)));
  };
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (std::size_t i = 0; i < regressor.values.size(); ++i) {
    if (!(weights[i] > 0.0) || !std::isfinite(regressor.values[i])) continue;
    low = std::min(low, regressor.values[i]);
    high = std::max(high, regressor.values[i]);
  }
  if (!(high > low)) return {};
  if (regressor.angle && high - low > kTurnsOnce) {
    return OfEqualWidth(WithinTurn(regressor.values), weights, 0.0, kTwoPi,
                        count(kFewestSectors, kMostSectors));
  }
  std::vector<Range> few = OfFewValues(regressor.values, weights, low, high - low);
  return few.empty() ? OfEqualWidth(regressor.values, weights, low, high, count(kFewestRanges, kMostRanges))
                     : few;
}

RangeError ErrorIn(const Range& range, std::span<const double> errors, std::span<const double> weights,
                   const SquaredNoise& noise, double filtered_out, double error_allowed) {
  double squares = 0.0;
  double weighted = 0.0;
  for (const std::size_t i : range.samples) {
    squares += errors[i] * errors[i];
    weighted += weights[i] * errors[i] * errors[i];
  }
  const auto count = static_cast<double>(range.samples.size());
  RangeError error{std::sqrt(squares / count + filtered_out), Validity::kHolds};
  if (!(noise.mean > 0.0)) {
    error.validity = weighted > 0.0 ? Validity::kFails : Validity::kHolds;
    return error;
  }
  const double freedom = std::max(1e-3, noise.degrees_of_freedom_per_sample * count);
  const boost::math::chi_squared chi_squared(freedom);
  const double excess = weighted / count / noise.mean;  // of the mean square
  const double upper = excess * freedom / boost::math::quantile(chi_squared, kOutsideUpperBound);
  const double lower =
      excess * freedom / boost::math::quantile(boost::math::complement(chi_squared, error_allowed));
  if (upper <= kToleratedExcess * kToleratedExcess) return error;
  error.validity = lower > 1.0 ? Validity::kFails : Validity::kTooFew;
  return error;
}

}  // namespace

TrustedRegions FindTrustedRegions(const Study& study, std::span<const double> weights,
                                  std::span<const double> noise, const HeldOutErrors& errors) {
  RequireSameLength("weights", weights, "measured", study.measured());
  RequireSameLength("noise", noise, "measured", study.measured());
  RequireSameLength("errors.nominal", errors.nominal, "measured", study.measured());
  RequireSameLength("errors.extended", errors.extended, "measured", study.measured());
  const SquaredNoise squared = SquaredNoiseOf(noise, weights, study.NoiseFloor());
  const double filtered_out = study.FilteredOutVariance();
  TrustedRegions regions{std::sqrt(squared.mean + filtered_out), {}};
  const auto with_weight = std::ranges::count_if(weights, [](double weight) { return weight > 0.0; });
  const double independent_samples = squared.degrees_of_freedom_per_sample * static_cast<double>(with_weight);
  std::vector<std::vector<Range>> ranges;
  std::size_t tests = 0;
  for (const Regressor& regressor : study.regressors()) {
    ranges.push_back(RangesOf(regressor, weights, independent_samples));
    std::erase_if(ranges.back(), [](const Range& range) { return range.samples.empty(); });
    tests += ranges.back().size();
  }
  const double error_allowed = kTrustFamilyError / static_cast<double>(std::max<std::size_t>(1, tests));
  for (const std::vector<Range>& of_regressor : ranges) {
    std::vector<RegressorRange>& over = regions.over.emplace_back();
    for (const Range& range : of_regressor) {
      over.push_back({range.low, range.high, range.samples.size(),
                      ErrorIn(range, errors.nominal, weights, squared, filtered_out, error_allowed),
                      ErrorIn(range, errors.extended, weights, squared, filtered_out, error_allowed)});
    }
  }
  return regions;
}

}  // namespace strainwave::analysis::diagnosis
