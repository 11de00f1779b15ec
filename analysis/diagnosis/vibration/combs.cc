// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/combs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "analysis/vector_clones.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr int kLengths[] = {1, 2, 3, 4, 6, 9, 13, 19, 28, 40};
constexpr std::size_t kMostHarmonics = 160;
// Weaker combs than this never stand up to the number of search locations.
constexpr double kLeastCombExcess = 14.0;
constexpr double kLeastNear = 6.0;  // beside an order that is known
// Combs this much weaker than the strongest are not among the few that are wanted.
constexpr double kLeastShare = 0.3;

using Powers = std::array<double, kMostHarmonics + 1>;

// Powers at the harmonics of an order and at those with their sidebands, from 1; returns how many there are.
struct Harmonics {
  Powers strongest{};  // line of each harmonic and its sidebands
  Powers with_sidebands{};
  int count{};
  double sideband{};

  void Take(const VibrationSpectrum& spectrum, double order) {
    count = static_cast<int>(std::min<double>(kMostHarmonics, spectrum.highest() / order));
    for (int k = 1; k <= count; ++k) {
      const auto index = static_cast<std::size_t>(k);
      strongest[index] = with_sidebands[index] = spectrum.At(k * order);
      if (!(sideband > 0.0)) continue;
      for (const double side : {-sideband, sideband}) {
        const double power = spectrum.At(k * order + side);
        strongest[index] = std::max(strongest[index], power);
        with_sidebands[index] += power;
      }
    }
  }
};

// Sum of so many cells that has this excess.
double SumOf(double excess, double cells) {
  const double wanted = excess / cells;
  double mean = 1.0 + std::sqrt(2.0 * wanted) + wanted;
  for (int round = 0; round < 4; ++round) mean -= (mean - 1.0 - std::log(mean) - wanted) / (1.0 - 1.0 / mean);
  return cells * mean;
}

// Sums without their strongest line that ranges of harmonics have to reach.
class Limits {
 public:
  Limits(double channels, double lines, double excess) : channels_(channels), lines_(lines) { Raise(excess); }

  double CellsOf(int length) const { return channels_ * (lines_ * length - 1.0); }
  double operator[](std::size_t which) const { return least_[which]; }
  /// Takes a comb's excess into account; by steps, so that it is rarely work.
  void Raise(double excess) {
    if (excess < 1.1 * excess_) return;
    excess_ = excess;
    for (std::size_t l = 0; l < std::size(kLengths); ++l) {
      const double cells = CellsOf(kLengths[l]);
      least_[l] = cells > 0.0 ? SumOf(excess, cells) : 1e300;
    }
  }

 private:
  double channels_{};
  double lines_{};
  double excess_{};
  std::array<double, std::size(kLengths)> least_{};
};

Limits LimitsFor(const VibrationSpectrum& spectrum, double sideband, double excess) {
  return {static_cast<double>(spectrum.channels()), sideband > 0.0 ? 3.0 : 1.0, excess};
}

// Whether any range of so many has a sum that reaches a limit.
// @param sums  of the powers up to each harmonic, from 0 to the last one
STRAINWAVE_VECTOR_CLONES
bool AnyReaches(std::span<const double> sums, std::size_t length, double limit) {
  int reach = 0;
  for (std::size_t before = 0; before + length < sums.size(); ++before)
    reach |= static_cast<int>(!(sums[before + length] - sums[before] < limit));
  return reach != 0;
}

Comb BestRange(const Harmonics& harmonics, double channels, double order, const Limits& limits) {
  Comb best{order, 1, 1, 0.0, 1.0, harmonics.sideband};
  const Powers& powers = harmonics.with_sidebands;
  const double lines = harmonics.sideband > 0.0 ? 3.0 : 1.0;
  Powers sums{};
  for (int k = 1; k <= harmonics.count; ++k) {
    sums[static_cast<std::size_t>(k)] =
        sums[static_cast<std::size_t>(k - 1)] + powers[static_cast<std::size_t>(k)];
  }
  for (std::size_t l = 0; l < std::size(kLengths); ++l) {
    const int length = kLengths[l];
    const std::span<const double> all(sums.data(), static_cast<std::size_t>(harmonics.count) + 1);
    if (!AnyReaches(all, static_cast<std::size_t>(length), limits[l])) continue;
    for (int first = 1; first + length - 1 <= harmonics.count; ++first) {
      const int last = first + length - 1;
      const double sum = sums[static_cast<std::size_t>(last)] - sums[static_cast<std::size_t>(first - 1)];
      if (sum < limits[l]) continue;
      const double strongest =
          *std::max_element(harmonics.strongest.begin() + first, harmonics.strongest.begin() + last + 1);
      if (sum - strongest < limits[l]) continue;
      const double excess = ExcessOf(sum - strongest, limits.CellsOf(length));
      if (excess > best.excess) best = {order, first, last, excess, 0.0, harmonics.sideband};
    }
  }
  double weight = 0.0;
  for (int k = best.first; k <= best.last && best.excess > 0.0; ++k) {
    const double above = std::max(0.0, powers[static_cast<std::size_t>(k)] - lines * channels);
    best.centre += above * k;
    weight += above;
  }
  best.centre = weight > 0.0 ? best.centre / weight : 0.5 * (best.first + best.last);
  return best;
}

double StepAt(const VibrationSpectrum& spectrum, double order) {
  const double harmonics = std::min<double>(kMostHarmonics, spectrum.highest() / order);
  return 0.4 * spectrum.cell() / harmonics;
}

}  // namespace

Comb CombNear(const VibrationSpectrum& spectrum, double order, double range, double sideband) {
  Harmonics harmonics;
  harmonics.sideband = sideband;
  Comb best{order, 1, 1, -1.0, 1.0, sideband};
  const Limits limits = LimitsFor(spectrum, sideband, kLeastNear);
  const double step = StepAt(spectrum, order);
  for (double change = 0.0; change <= range + 0.5 * step; change += step) {
    for (const double near : {order - change, order + change}) {
      harmonics.Take(spectrum, near);
      const Comb comb = BestRange(harmonics, static_cast<double>(spectrum.channels()), near, limits);
      if (comb.excess > best.excess) best = comb;
    }
  }
  return best;
}

Comb Refined(const VibrationSpectrum& spectrum, Comb comb) {
  const double step = 0.1 * spectrum.cell() / comb.last;
  double most = 0.0;
  const double centre = comb.order;
  for (int i = -10; i <= 10; ++i) {
    const double order = centre + i * step;
    double sum = 0.0;
    for (int k = comb.first; k <= comb.last; ++k) {
      sum += spectrum.At(k * order);
      if (comb.sideband > 0.0)
        sum += spectrum.At(k * order - comb.sideband) + spectrum.At(k * order + comb.sideband);
    }
    if (sum > most) {
      most = sum;
      comb.order = order;
    }
  }
  return comb;
}

std::vector<Comb> FindCombs(const VibrationSpectrum& spectrum, double lowest, double highest, double sideband,
                            std::size_t count, const std::function<bool(double order)>& allowed) {
  std::vector<Comb> found;
  Harmonics harmonics;
  harmonics.sideband = sideband;
  highest = std::min(highest, 0.5 * spectrum.highest());
  Limits limits = LimitsFor(spectrum, sideband, kLeastCombExcess);
  for (double order = lowest; order < highest; order += StepAt(spectrum, order)) {
    if (!allowed(order)) continue;
    harmonics.Take(spectrum, order);
    const Comb comb = BestRange(harmonics, static_cast<double>(spectrum.channels()), order, limits);
    if (comb.excess > kLeastCombExcess) found.push_back(comb);
    limits.Raise(kLeastShare * comb.excess);
  }
  std::sort(found.begin(), found.end(), [](const Comb& a, const Comb& b) { return a.excess > b.excess; });
  std::vector<Comb> chosen;
  for (const Comb& comb : found) {
    if (chosen.size() == count) break;
    const bool near = std::any_of(chosen.begin(), chosen.end(), [&](const Comb& other) {
      return std::abs(other.order - comb.order) < 2.0 * spectrum.cell() / other.last;
    });
    if (!near) chosen.push_back(comb);
  }
  return chosen;
}

}  // namespace strainwave::analysis::diagnosis
