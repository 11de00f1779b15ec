// SPDX-License-Identifier: Apache-2.0
#include "analysis/samples/holds.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "analysis/noise_level.h"
#include "analysis/samples/resolution.h"
#include "analysis/units.h"

namespace strainwave::analysis::samples {
namespace {

using Run = Frozen;

std::vector<Run> RunsOf(std::span<const double> values) { return StandingSegments(values, 1); }

// Neighbours that would be equal in a signal of this resolution, by how many differ by little. The resolution
// is the usual distance of its values where they lie densely.
double RepeatsByChance(std::span<const double> values, std::size_t runs) {
  constexpr double kComesAgain =
      0.9;  // distinct values a run: more, and the resolution is not what makes them equal
  std::vector<double> changes;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] != values[i - 1]) changes.push_back(std::abs(values[i] - values[i - 1]));
  }
  const std::set<double> distinct(values.begin(), values.end());
  if (changes.size() < 5 || distinct.size() < 4) return 0.0;
  if (static_cast<double>(distinct.size()) > kComesAgain * static_cast<double>(runs)) return 0.0;
  std::vector<double> gaps;
  std::size_t k = 0;
  for (auto at = std::next(distinct.begin()); at != distinct.end(); ++at, ++k) {
    if (4 * k >= distinct.size() && 4 * k <= 3 * distinct.size()) gaps.push_back(*at - *std::prev(at));
  }
  const auto fifth = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 5);
  std::nth_element(changes.begin(), fifth, changes.end());
  return 0.2 * static_cast<double>(changes.size()) * Median(std::move(gaps)) / (2.0 * *fifth);
}

// Of the white part, without those where the signal stands: from fourth differences, which motion hardly
// enters, and from second ones, of which a ramp of a few rows has some beside its corners.
double NoiseWhereItMoves(std::span<const double> values) {
  std::vector<double> fourth;
  for (std::size_t i = 2; i + 2 < values.size(); ++i) {
    if (values[i] != values[i - 1] || values[i + 1] != values[i]) {
      fourth.push_back(values[i - 2] - 4.0 * values[i - 1] + 6.0 * values[i] - 4.0 * values[i + 1] +
                       values[i + 2]);
    }
  }
  std::vector<double> second;
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    if (values[i] != values[i - 1] && values[i + 1] != values[i])
      second.push_back(values[i - 1] - 2.0 * values[i] + values[i + 1]);
  }
  return std::min(RobustStandardDeviation(fourth) / std::sqrt(70.0),
                  RobustStandardDeviation(second) / std::sqrt(6.0));
}

// Whether a value was left, or come to, by a jump as nothing else in the signal makes one: it went on
// meanwhile.
std::vector<Frozen> LeftByAJump(std::span<const double> values) {
  constexpr std::size_t kFewestRows = 8;
  constexpr double kClearly = 3.0;  // times the largest other change
  const std::vector<Frozen> long_ones = StandingSegments(values, kFewestRows);
  std::vector<bool> beside(values.size(), false);  // of the change to the value before
  for (const Frozen& one : long_ones) {
    beside[one.first] = true;
    if (one.first + one.count < values.size()) beside[one.first + one.count] = true;
  }
  // To or from a single value that stands off its neighbours there is none.
  const auto change = [&](std::size_t i) {
    if (i == 0 || i >= values.size()) return 0.0;
    double least = std::abs(values[i] - values[i - 1]);
    if (i > 1) least = std::min(least, std::abs(values[i] - values[i - 2]));
    if (i + 1 < values.size()) least = std::min(least, std::abs(values[i + 1] - values[i - 1]));
    return least;
  };
  double largest = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (!beside[i]) largest = std::max(largest, change(i));
  }
  std::vector<Frozen> jumped;
  for (const Frozen& one : long_ones) {
    if (largest > 0.0 && std::max(change(one.first), change(one.first + one.count)) > kClearly * largest)
      jumped.push_back(one);
  }
  return jumped;
}

// How finely a signal is told: between neighbours where it is slow, between any two of its values where it is
// not.
double ResolutionOf(std::span<const double> values) {
  constexpr std::size_t kPart = 100;  // of the distances so many may be odd ones, of spikes
  const std::set<double> distinct(values.begin(), values.end());
  std::vector<double> distances;
  for (auto at = distinct.begin(); at != distinct.end() && std::next(at) != distinct.end(); ++at)
    distances.push_back(*std::next(at) - *at);
  double step = EstimateNoise(values).step;
  if (!distances.empty()) {
    const auto quantile = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / kPart);
    std::nth_element(distances.begin(), quantile, distances.end());
    step = std::min(step, *quantile);
  }
  return std::max(step, QuantisationStep(values));
}

struct Ends {
  double low{};
  double high{};
};

Ends EndsOf(std::span<const double> values) {
  if (values.empty()) return {};
  const auto [low, high] = std::ranges::minmax(values);
  return {low, high};
}

// Chance that the signal's own noise gives a value once more, to the last digit; nothing where it has no
// noise that is seen.
std::optional<double> ChanceOfRepeat(std::span<const double> values) {
  constexpr double kVisibleNoise = 2.0;  // steps: less, and a value often comes again
  if (values.size() < 16) return std::nullopt;
  const double step = ResolutionOf(values);
  const double noise = NoiseWhereItMoves(values);
  if (!(noise > kVisibleNoise * step)) return std::nullopt;
  // Two neighbours' difference is normal with √2 of the deviation; half of the step to either side is none.
  return step / (2.0 * std::sqrt(kPi) * noise);
}

// Whether a signal stands as long between its ends as at them: it is held, and its range does not end there.
bool RestsElsewhere(std::span<const double> values, const std::vector<Run>& runs) {
  constexpr std::size_t kFewestRows = 8;
  const Ends ends = EndsOf(values);
  std::size_t at_ends = 0;
  std::size_t between = 0;
  for (const Run& run : runs) {
    const bool end = values[run.first] == ends.low || values[run.first] == ends.high;
    std::size_t& longest = end ? at_ends : between;
    longest = std::max(longest, run.count);
  }
  return between >= kFewestRows && 2 * between >= at_ends;
}

constexpr double kNever = 1e-9;  // chance in a whole record

// Chance of a run somewhere in so many rows.
double ChanceOf(const Run& run, double repeat, std::size_t rows) {
  return static_cast<double>(rows) * std::pow(repeat, static_cast<double>(run.count - 1));
}

}  // namespace

std::optional<Held> FindHeld(std::span<const double> values, double coarsest_step) {
  constexpr std::size_t kFewestRuns = 10;
  constexpr double kLeastShare = 0.02;  // of all values: an axis stops less often
  constexpr double kClearly = 3.0;      // steps; an encoder that hardly turns goes on by one
  constexpr double kOfAStep = 0.01;     // tolerance: the changes of a slow ramp are alike, but not that much
  constexpr double kByChance = 3.0;     // times what the signal's own small changes predict
  constexpr std::size_t kFewLevels = 20;  // of a command in steps
  const std::vector<Run> runs = RunsOf(values);
  const double step = QuantisationStep(values, kOfAStep);
  const double clear = step <= coarsest_step ? kClearly * step : 0.0;
  Held held;
  held.fresh.assign(values.size(), true);
  std::set<double> levels;
  for (std::size_t k = 1; k + 1 < runs.size(); ++k) {
    const Run& run = runs[k];
    const double value = values[run.first];
    if (run.count < 2 || std::abs(value - values[run.first - 1]) < clear ||
        std::abs(values[run.first + run.count] - value) < clear) {
      continue;
    }
    ++held.runs;
    held.longest = std::max(held.longest, run.count);
    std::fill_n(held.fresh.begin() + static_cast<std::ptrdiff_t>(run.first + 1), run.count - 1, false);
    if (levels.size() <= kFewLevels) levels.insert(value);
  }
  const bool often = static_cast<double>(held.runs) >= kLeastShare * static_cast<double>(runs.size());
  if (held.runs < kFewestRuns || !often || levels.size() <= kFewLevels) return std::nullopt;
  held.repeated = static_cast<std::size_t>(std::count(held.fresh.begin(), held.fresh.end(), false));
  if (static_cast<double>(held.repeated) < kByChance * RepeatsByChance(values, runs.size()))
    return std::nullopt;
  // Nor is a value at the ends of the record a new one each time.
  for (const Run& run : runs) {
    if (run.count <= held.longest)
      std::fill_n(held.fresh.begin() + static_cast<std::ptrdiff_t>(run.first + 1), run.count - 1, false);
  }
  held.repeated = static_cast<std::size_t>(std::count(held.fresh.begin(), held.fresh.end(), false));
  return held;
}

double GoesOnMeanwhile(const Held& held, std::span<const double> other) {
  std::vector<double> standing;
  std::vector<double> changing;
  for (std::size_t i = 1; i < other.size(); ++i)
    (held.fresh[i] ? changing : standing).push_back(std::abs(other[i] - other[i - 1]));
  const double usual = Median(std::move(changing));
  return usual > 0.0 ? Median(std::move(standing)) / usual : 1.0;
}

std::vector<Frozen> FindFrozen(std::span<const double> values) {
  const std::optional<double> repeat = ChanceOfRepeat(values);
  if (!repeat) return LeftByAJump(values);
  std::vector<Run> segments = RunsOf(values);
  const std::vector<Frozen> jumped = LeftByAJump(values);
  std::erase_if(segments, [&, ends = EndsOf(values)](const Run& run) {
    const double value = values[run.first];
    // A signal comes back into its range as it left it, one that stood still meanwhile does not.
    const bool clipped = (value == ends.low || value == ends.high) &&
                         std::ranges::find(jumped, run.first, &Frozen::first) == jumped.end();
    return clipped || ChanceOf(run, *repeat, values.size()) >= kNever;
  });
  return segments;
}

std::vector<Saturated> FindSaturated(std::span<const double> values) {
  const std::optional<double> repeat = ChanceOfRepeat(values);
  if (!repeat) return {};
  const std::vector<Run> runs = RunsOf(values);
  if (RestsElsewhere(values, runs)) return {};
  // Each peak of a periodic signal ends in the same value.
  const auto chance_of = [&](double end) {
    double chance = 1.0;
    for (const Run& run : runs) {
      if (values[run.first] == end) chance *= std::min(1.0, ChanceOf(run, *repeat, values.size()));
    }
    return chance;
  };
  // A sensor's range has two ends: where the signal stands at either, one speaks for the other.
  constexpr double kUnlikely = 1e-3;
  const Ends ends = EndsOf(values);
  const double of_both = chance_of(ends.low) * chance_of(ends.high);
  std::vector<Saturated> found;
  for (const double end : {ends.low, ends.high}) {
    const double chance = chance_of(end);
    if (chance < kNever || (chance < kUnlikely && of_both < kNever))
      found.push_back({end, static_cast<std::size_t>(std::ranges::count(values, end))});
  }
  return found;
}

std::vector<Frozen> StandingSegments(std::span<const double> values, std::size_t fewest) {
  std::vector<Frozen> segments;
  for (std::size_t i = 0; i < values.size();) {
    std::size_t next = i + 1;
    while (next < values.size() && values[next] == values[i]) ++next;
    if (next - i >= fewest) segments.push_back({i, next - i});
    i = next;
  }
  return segments;
}

}  // namespace strainwave::analysis::samples
