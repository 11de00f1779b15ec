// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/scans.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <unsupported/Eigen/FFT>

#include "analysis/diagnosis/line_sums.h"
#include "analysis/diagnosis/phasors.h"
#include "analysis/noise_level.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Between two grid points either side of `order`: golden section on the exact sums.
LinePeak Refine(std::span<const double> angle, std::span<const double> residual,
                std::span<const double> weights, double order, double half_width, double lowest) {
  constexpr double kGolden = 0.6180339887498949;
  const LineSumsNear sums(angle, residual, weights, order, half_width);
  double low = std::max(order - half_width, lowest);
  double high = order + half_width;
  double a = high - kGolden * (high - low);
  double b = low + kGolden * (high - low);
  double at_a = sums.Drop(a);
  double at_b = sums.Drop(b);
  for (int i = 0; i < 12; ++i) {
    if (at_a > at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = sums.Drop(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = sums.Drop(b);
    }
  }
  return at_a > at_b ? LinePeak{a, at_a} : LinePeak{b, at_b};
}

// Median within `reach` grid points to either side, taken on a coarse raster; never zero.
std::vector<double> LocalLevel(const std::vector<double>& drops, std::size_t reach) {
  std::vector<double> level(drops.size());
  double sum = 0.0;
  for (const double drop : drops) sum += drop;
  const double least = 1e-3 * sum / static_cast<double>(drops.size()) + 1e-300;
  const std::size_t raster = std::max<std::size_t>(1, reach / 4);
  for (std::size_t first = 0; first < drops.size(); first += raster) {
    const std::size_t middle = std::min(first + raster / 2, drops.size() - 1);
    const auto from = drops.begin() + static_cast<std::ptrdiff_t>(middle > reach ? middle - reach : 0);
    const auto to = drops.begin() + static_cast<std::ptrdiff_t>(std::min(middle + reach + 1, drops.size()));
    const double here = std::max(least, Median({from, to}));
    std::fill(level.begin() + static_cast<std::ptrdiff_t>(first),
              level.begin() + static_cast<std::ptrdiff_t>(std::min(first + raster, drops.size())), here);
  }
  return level;
}

// The smallest even length from this one on that the transform is quick for.
std::size_t FastLengthFrom(std::size_t length) {
  for (std::size_t size = length + length % 2;; size += 2) {
    std::size_t rest = size;
    for (const std::size_t factor : {2, 3, 5}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1) return size;
  }
}

// What of a residual lies below each abscissa.
struct SortedSums {
  std::vector<double> at;  // rising
  std::vector<double> weight{0.0};
  std::vector<double> value{0.0};

  SortedSums(std::span<const double> abscissa, std::span<const double> residual,
             std::span<const double> weights) {
    std::vector<std::size_t> order(abscissa.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return abscissa[a] < abscissa[b]; });
    for (const std::size_t i : order) {
      if (!(weights[i] > 0.0)) continue;
      at.push_back(abscissa[i]);
      weight.push_back(weight.back() + weights[i]);
      value.push_back(value.back() + weights[i] * residual[i]);
    }
  }
  std::size_t Below(double end) const {
    return static_cast<std::size_t>(std::lower_bound(at.begin(), at.end(), end) - at.begin());
  }
  // Of the sum of squares by another mean of the samples [first, last); 0 where they are nearly all.
  double Drop(std::size_t first, std::size_t last) const {
    const double all = weight.back();
    const double inside = weight[last] - weight[first];
    if (last < first + 2 || inside > 0.9 * all) return 0.0;
    const double sum = value[last] - value[first] - value.back() / all * inside;
    return sum * sum / (inside * (1.0 - inside / all));
  }
};

// The best windows over all widths and centres, at least a width apart.
std::vector<WindowPeak> Windows(const SortedSums& sums, double narrowest, double widest, std::size_t count) {
  if (sums.at.size() < 3 || !WindowsMove(sums.at, narrowest)) return {};
  std::vector<WindowPeak> found;
  for (double width = narrowest; width <= widest * 1.0001; width *= std::sqrt(2.0)) {
    for (double low = sums.at.front() - 0.5 * width; low < sums.at.back(); low += 0.25 * width) {
      const double drop = sums.Drop(sums.Below(low), sums.Below(low + width));
      if (drop > 0.0) found.push_back({low + 0.5 * width, width, drop});
    }
  }
  std::sort(found.begin(), found.end(),
            [](const WindowPeak& a, const WindowPeak& b) { return a.drop > b.drop; });
  std::vector<WindowPeak> peaks;
  for (const WindowPeak& peak : found) {
    if (peaks.size() == count) break;
    const bool close = std::any_of(peaks.begin(), peaks.end(), [&](const WindowPeak& other) {
      return std::abs(peak.centre - other.centre) < std::max(peak.width, other.width);
    });
    if (!close) peaks.push_back(peak);
  }
  return peaks;
}

// The window with the ends that fit best near those of one that was found.
WindowPeak Sharpened(const SortedSums& sums, double narrowest, double widest, const WindowPeak& found) {
  const std::vector<double>& at = sums.at;
  std::size_t first = sums.Below(found.centre - 0.5 * found.width);
  std::size_t last = sums.Below(found.centre + 0.5 * found.width);
  double drop = sums.Drop(first, last);
  const auto takes_more = [&](std::size_t low, std::size_t high) {
    const double width = at[high - 1] - at[low];
    return width >= narrowest && width <= widest && sums.Drop(low, high) > drop;
  };
  constexpr int kMostRounds = 20;
  bool moved = true;
  for (int round = 0; moved && round < kMostRounds; ++round) {
    const double before = drop;
    for (std::size_t k = 0; k + 2 <= last; ++k) {
      if (!takes_more(k, last)) continue;
      first = k;
      drop = sums.Drop(first, last);
    }
    for (std::size_t k = first + 2; k <= at.size(); ++k) {
      if (!takes_more(first, k)) continue;
      last = k;
      drop = sums.Drop(first, last);
    }
    moved = drop > before;
  }
  if (last < first + 2) return found;
  // An end lies halfway to the next sample, at the ends of the record as far beyond it as within.
  const auto between = [&](std::size_t k) {
    if (k == 0) return at[0] - 0.5 * (at[1] - at[0]);
    if (k == at.size()) return at[k - 1] + 0.5 * (at[k - 1] - at[k - 2]);
    return 0.5 * (at[k - 1] + at[k]);
  };
  return {0.5 * (between(first) + between(last)), between(last) - between(first), drop};
}

}  // namespace

double SpanOf(std::span<const double> values) {
  if (values.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

double LineDrop(std::span<const double> angle, std::span<const double> residual,
                std::span<const double> weights, double order) {
  LineSums sums{};
  ForEachPhasor(angle, order, [&](std::size_t i, std::complex<double> phasor) {
    const double w = weights[i];
    if (!(w > 0.0)) return;
    const double c = phasor.real();
    const double s = phasor.imag();
    sums.w += w;
    sums.y += w * residual[i];
    sums.c += w * c;
    sums.s += w * s;
    sums.yc += w * residual[i] * c;
    sums.ys += w * residual[i] * s;
    sums.cc += w * c * c;
    sums.ss += w * s * s;
    sums.cs += w * c * s;
  });
  return sums.Drop();
}

double IndependentOrders(std::span<const double> angle_rad, double lowest_order, double highest_order) {
  return std::max(1.0, (highest_order - lowest_order) * SpanOf(angle_rad) / kTwoPi);
}

std::vector<LinePeak> FindLines(std::span<const double> angle_rad, std::span<const double> residual,
                                std::span<const double> weights, double lowest_order, double highest_order,
                                std::size_t count, double even_step) {
  const double span = SpanOf(angle_rad);
  if (!(span > 0.0) || !(highest_order > lowest_order) || count == 0) return {};
  constexpr double kOversampling = 4.0;
  const double cell = kTwoPi / span;
  double step = cell / kOversampling;
  // Samples fall into bins of an eighth of the shortest period of the doubled order at most.
  const double bins_needed = 8.0 * 2.0 * (highest_order + cell) / step;
  std::size_t bins = 1024;
  while (static_cast<double>(bins) < bins_needed && bins < (std::size_t{1} << 22)) bins *= 2;
  const double steps = even_step > 0.0 ? kOversampling * std::round(span / even_step) : 0.0;
  const bool even = steps > 0.0 && steps < 0.5 * static_cast<double>(bins);
  if (even) {
    bins = FastLengthFrom(static_cast<std::size_t>(steps));
    step = kTwoPi / (even_step * static_cast<double>(bins));
  }
  const double first = *std::min_element(angle_rad.begin(), angle_rad.end());
  const double per_bin = kTwoPi / step / static_cast<double>(bins);

  double mean_weight = 0.0;
  double mean = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    mean_weight += weights[i];
    mean += weights[i] * residual[i];
  }
  if (!(mean_weight > 0.0)) return {};
  mean /= mean_weight;
  // Real part: weights; imaginary part: weighted residuals. One transform gives both.
  std::vector<std::complex<double>> binned(bins);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const auto bin = static_cast<std::size_t>((angle_rad[i] - first) / per_bin + 0.5) % bins;
    binned[bin] += std::complex<double>(weights[i], weights[i] * (residual[i] - mean));
  }
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, binned);
  const auto parts = [&](std::size_t k) {
    const std::complex<double> z = spectrum[k % bins];
    const std::complex<double> mirrored = std::conj(spectrum[(bins - k % bins) % bins]);
    return std::pair{0.5 * (z + mirrored), std::complex<double>(0.0, -0.5) * (z - mirrored)};
  };
  const auto from = static_cast<std::size_t>(std::max(1.0, std::ceil(lowest_order / step)));
  const auto to =
      std::min(static_cast<std::size_t>(std::floor(highest_order / step)) + 1, even ? bins / 2 : bins / 4);
  if (to <= from) return {};
  std::vector<double> drops(to - from + 1, 0.0);
  for (std::size_t k = from; k <= to; ++k) {
    const auto [window, data] = parts(k);
    const auto doubled = parts(2 * k).first;
    drops[k - from] = LineSums{.w = mean_weight,
                               .y = 0.0,
                               .c = window.real(),
                               .s = -window.imag(),
                               .yc = data.real(),
                               .ys = -data.imag(),
                               .cc = 0.5 * (mean_weight + doubled.real()),
                               .ss = 0.5 * (mean_weight - doubled.real()),
                               .cs = -0.5 * doubled.imag()}
                          .Drop();
  }
  const std::vector<double> level = LocalLevel(drops, static_cast<std::size_t>(30.0 * cell / step));
  const auto prominence = [&](std::size_t bin) { return drops[bin] / level[bin]; };
  std::vector<std::size_t> ranked(drops.size());
  std::iota(ranked.begin(), ranked.end(), std::size_t{0});
  // No more are looked at than lie near the peaks that are taken.
  const std::size_t near = count * (2 * static_cast<std::size_t>(std::ceil(cell / step)) + 5);
  std::partial_sort(ranked.begin(),
                    ranked.begin() + static_cast<std::ptrdiff_t>(std::min(near, ranked.size())), ranked.end(),
                    [&](std::size_t a, std::size_t b) { return prominence(a) > prominence(b); });
  // A line over an angle at which the samples crowd raises its surroundings with it.
  const auto highest = static_cast<std::size_t>(std::ranges::max_element(drops) - drops.begin());
  ranked.insert(ranked.begin() + 1, highest);
  std::vector<LinePeak> peaks;
  for (const std::size_t bin : ranked) {
    if (peaks.size() == count || !(drops[bin] > 0.0)) break;
    const double order = static_cast<double>(bin + from) * step;
    const bool close = std::any_of(peaks.begin(), peaks.end(),
                                   [&](const LinePeak& peak) { return std::abs(peak.order - order) < cell; });
    if (!close) peaks.push_back(Refine(angle_rad, residual, weights, order, step, 0.5 * lowest_order));
  }
  return peaks;
}

double LogSearchLocationsOfLine(double order, double lowest_order, double highest_order) {
  const double within = std::clamp(order, lowest_order, highest_order);
  return std::log(within * std::log(highest_order / lowest_order) / (highest_order - lowest_order));
}

bool WindowsMove(std::span<const double> abscissa, double width) {
  // Of half a step, as the first window begins before the first abscissa.
  return std::ranges::all_of(abscissa, [width](double at) { return at + 0.125 * width > at; });
}

std::vector<WindowPeak> FindWindows(std::span<const double> abscissa, std::span<const double> residual,
                                    std::span<const double> weights, double narrowest, double widest,
                                    std::size_t count) {
  return Windows(SortedSums(abscissa, residual, weights), narrowest, widest, count);
}

std::vector<WindowPeak> FindSharpWindows(std::span<const double> abscissa, std::span<const double> residual,
                                         std::span<const double> weights, double narrowest, double widest,
                                         std::size_t count) {
  const SortedSums sums(abscissa, residual, weights);
  std::vector<WindowPeak> peaks = Windows(sums, narrowest, widest, count);
  for (WindowPeak& peak : peaks) peak = Sharpened(sums, narrowest, widest, peak);
  return peaks;
}

double LogSearchLocationsOfWidth(double width, double narrowest, double widest) {
  const double octaves = std::max(2.0, std::log2(widest / narrowest));
  return std::log(0.5 * octaves * narrowest / std::clamp(width, 0.5 * narrowest, widest));
}

}  // namespace strainwave::analysis::diagnosis
