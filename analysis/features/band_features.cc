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

const FourLanes* LanesAt(const double* place) { return reinterpret_cast<const FourLanes*>(place); }

double SumOf(const FourLanes& lanes) {
  const auto* v = reinterpret_cast<const double*>(&lanes);
  return (v[0] + v[1]) + (v[2] + v[3]);
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

// In two passes: more sums than these do not fit into the registers of a machine.
STRAINWAVE_VECTOR_CLONES
void AddSigned(const double* x, std::size_t n, FirstSums& out) {
  FourLanes sum{};
  FourLanes magnitudes{};
  FourLanes squares{};
  FourLanes least = x[0] - FourLanes{};
  FourLanes greatest = least;
  std::size_t i = 0;
  for (; i + kFourLanes <= n; i += kFourLanes) {
    const FourLanes v = *LanesAt(x + i);
    sum += v;
    magnitudes += v < 0.0 ? -v : v;
    squares += v * v;
    least = v < least ? v : least;
    greatest = v > greatest ? v : greatest;
  }
  out.sum = SumOf(sum);
  out.magnitudes = SumOf(magnitudes);
  out.squares = SumOf(squares);
  out.least = least[0];
  out.greatest = greatest[0];
  for (int lane = 1; lane < kFourLanes; ++lane) {
    out.least = std::min(out.least, least[lane]);
    out.greatest = std::max(out.greatest, greatest[lane]);
  }
  for (; i < n; ++i) {
    out.sum += x[i];
    out.magnitudes += std::abs(x[i]);
    out.squares += x[i] * x[i];
    out.least = std::min(out.least, x[i]);
    out.greatest = std::max(out.greatest, x[i]);
  }
}

STRAINWAVE_VECTOR_CLONES
void AddLogarithms(const double* x, const double* roots, const double* logs, std::size_t n, FirstSums& out) {
  FourLanes root_sum{};
  FourLanes log_sum{};
  FourLanes entropy{};
  std::size_t i = 0;
  for (; i + kFourLanes <= n; i += kFourLanes) {
    const FourLanes v = *LanesAt(x + i);
    const FourLanes log_square = *LanesAt(logs + i);
    root_sum += *LanesAt(roots + i);
    log_sum += log_square;
    entropy += v * v * log_square;
  }
  out.roots = SumOf(root_sum);
  out.logs = SumOf(log_sum);
  out.entropy = SumOf(entropy);
  for (; i < n; ++i) {
    out.roots += roots[i];
    out.logs += logs[i];
    out.entropy += x[i] * x[i] * logs[i];
  }
}

struct Moments {
  double second, third, fourth;  // sums of powers of x − mean
};

STRAINWAVE_VECTOR_CLONES
void AddMoments(const double* x, std::size_t n, double mean, Moments& out) {
  FourLanes second{};
  FourLanes third{};
  FourLanes fourth{};
  std::size_t i = 0;
  for (; i + kFourLanes <= n; i += kFourLanes) {
    const FourLanes away = *LanesAt(x + i) - mean;
    const FourLanes square = away * away;
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
  AddSigned(band.data(), n, sums);
  AddLogarithms(band.data(), workspace.roots.data(), workspace.logs.data(), n, sums);
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
