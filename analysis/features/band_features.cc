// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "analysis/features/packet_features.h"
#include "analysis/vector_clones.h"

// The library's header says this itself only under -ffast-math, which would also forget what NaN is.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
extern "C" {
__attribute__((simd("notinbranch"))) double log(double) noexcept;
}
#endif

namespace strainwave::analysis::features {
namespace {

constexpr double kSmallest = std::numeric_limits<double>::min();

const Lanes* LanesAt(const double* place) { return reinterpret_cast<const Lanes*>(place); }

double SumOf(const Lanes& lanes) {
  const auto* v = reinterpret_cast<const double*>(&lanes);
  return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}

// Σ x, Σ |x|, Σ x², Σ √|x|, Σ ln x², Σ x² ln x², and the ends.
struct FirstSums {
  double sum, magnitudes, squares, roots, logs, entropy, least, greatest;
};

STRAINWAVE_VECTOR_CLONES
void RootsAndLogs(const double* x, std::size_t n, double* roots, double* logs) {
  for (std::size_t i = 0; i < n; ++i) roots[i] = std::sqrt(std::abs(x[i]));
  for (std::size_t i = 0; i < n; ++i) {
    const double square = x[i] * x[i];
    logs[i] = ::log(square < kSmallest ? kSmallest : square);
  }
}

STRAINWAVE_VECTOR_CLONES
void AddFirst(const double* x, const double* roots, const double* logs, std::size_t n, FirstSums& out) {
  Lanes sum{};
  Lanes magnitudes{};
  Lanes squares{};
  Lanes root_sum{};
  Lanes log_sum{};
  Lanes entropy{};
  Lanes least = x[0] - Lanes{};
  Lanes greatest = least;
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    const Lanes v = *LanesAt(x + i);
    const Lanes square = v * v;
    const Lanes log_square = *LanesAt(logs + i);
    sum += v;
    magnitudes += v < 0.0 ? -v : v;
    squares += square;
    root_sum += *LanesAt(roots + i);
    log_sum += log_square;
    entropy += square * log_square;
    least = v < least ? v : least;
    greatest = v > greatest ? v : greatest;
  }
  out = {SumOf(sum),     SumOf(magnitudes), SumOf(squares), SumOf(root_sum),
         SumOf(log_sum), SumOf(entropy),    least[0],       greatest[0]};
  for (int lane = 1; lane < kLanes; ++lane) {
    out.least = std::min(out.least, least[lane]);
    out.greatest = std::max(out.greatest, greatest[lane]);
  }
  for (; i < n; ++i) {
    out.sum += x[i];
    out.magnitudes += std::abs(x[i]);
    out.squares += x[i] * x[i];
    out.roots += roots[i];
    out.logs += logs[i];
    out.entropy += x[i] * x[i] * logs[i];
    out.least = std::min(out.least, x[i]);
    out.greatest = std::max(out.greatest, x[i]);
  }
}

struct Moments {
  double second, third, fourth;  // sums of powers of x − mean
};

STRAINWAVE_VECTOR_CLONES
void AddMoments(const double* x, std::size_t n, double mean, Moments& out) {
  Lanes second{};
  Lanes third{};
  Lanes fourth{};
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    const Lanes away = *LanesAt(x + i) - mean;
    const Lanes square = away * away;
    second += square;
    third += square * away;
    fourth += square * square;
  }
  out = {SumOf(second), SumOf(third), SumOf(fourth)};
  for (; i < n; ++i) {
    const double away = x[i] - mean;
    const double square = away * away;
    out.second += square;
    out.third += square * away;
    out.fourth += square * square;
  }
}

double Ratio(double above, double below) { return below > 0.0 ? above / below : 0.0; }

}  // namespace

std::size_t BandFeatures(std::span<const double> band, bool normalised_entropy, BandWorkspace& workspace,
                         std::span<double> out) {
  if (band.empty() || out.size() != kBandFeatures)
    throw std::invalid_argument("a band without a value, or another number of places than of features");
  const std::size_t n = band.size();
  workspace.roots.resize(n);
  workspace.logs.resize(n);
  RootsAndLogs(band.data(), n, workspace.roots.data(), workspace.logs.data());
  FirstSums sums{};
  AddFirst(band.data(), workspace.roots.data(), workspace.logs.data(), n, sums);
  const auto count = static_cast<double>(n);
  const double mean = sums.sum / count;
  Moments moments{};
  AddMoments(band.data(), n, mean, moments);
  // Of one value throughout, what is left of the mean's rounding is no deviation.
  const bool varies = sums.greatest > sums.least;
  const double variance = n > 1 && varies ? moments.second / (count - 1.0) : 0.0;
  const double std = std::sqrt(variance);
  const double rms = std::sqrt(sums.squares / count);
  const double peak = std::max(sums.greatest, -sums.least);
  const double magnitude = sums.magnitudes / count;
  const double root = sums.roots / count;
  double entropy = -sums.entropy;
  if (normalised_entropy)
    entropy = sums.squares > 0.0 ? std::log(sums.squares) - sums.entropy / sums.squares : 0.0;
  const double values[kBandFeatures] = {sums.squares,
                                        mean,
                                        std,
                                        rms,
                                        Ratio(moments.third / count, variance * std),
                                        Ratio(moments.fourth / count, variance * variance),
                                        Ratio(rms, magnitude),
                                        Ratio(peak, rms),
                                        Ratio(peak, magnitude),
                                        Ratio(peak, root * root),
                                        peak,
                                        sums.greatest - sums.least,
                                        entropy,
                                        sums.logs};
  std::copy(std::begin(values), std::end(values), out.begin());
  const double floor = std::log(kSmallest);
  return static_cast<std::size_t>(
      std::count_if(workspace.logs.begin(), workspace.logs.end(), [floor](double v) { return v <= floor; }));
}

}  // namespace strainwave::analysis::features
