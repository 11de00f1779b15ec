// SPDX-License-Identifier: Apache-2.0
// How often 90 % intervals of a Weibull law hold the truth, at few failures, with Fisher's, likelihood-ratio
// and standardised bounds; and how long a fit of many units with all its bounds takes.
//   life_benchmark coverage [SAMPLES]
//   life_benchmark forecast [LIVES]   when simulated units meet their limit, seen to shares of their lives
//   life_benchmark population [POPULATIONS]   the life of others like some units seen to a share of it
//   life_benchmark fit TIMES    one line a unit: TIME STATUS, status 1 for a failure
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "analysis/reliability/degradation.h"
#include "analysis/reliability/few_failures.h"
#include "analysis/reliability/limit_forecast.h"
#include "analysis/reliability/weibull_fit.h"
#include "tests/analysis/simulated_lives.h"
#include "tests/analysis/straight_line_forecast.h"

namespace {

using namespace strainwave::analysis::reliability;

constexpr double kShape = 2.0;
constexpr double kScale = 1000.0;

struct Tally {
  int held{};
  int below{};  // the truth lies below the interval
  void Take(const Interval& interval, double truth) {
    held += interval.low <= truth && truth <= interval.high;
    below += truth < interval.low;
  }
};

// `units`, of which those are suspended that live longer than `end`, or all after the first `failures`.
std::vector<Lifetime> Draw(int units, int failures, double end, std::mt19937_64& random) {
  std::weibull_distribution<double> law(kShape, kScale);
  std::vector<double> times;
  for (int i = 0; i < units; ++i) times.push_back(law(random));
  std::sort(times.begin(), times.end());
  std::vector<Lifetime> lives;
  for (int i = 0; i < units; ++i) {
    const double last = std::min(end, times[static_cast<std::size_t>(failures - 1)]);
    const double time = times[static_cast<std::size_t>(i)];
    lives.push_back(time <= last ? Lifetime::Failed(time) : Lifetime::Suspended(last));
  }
  return lives;
}

void Cover(const char* what, int units, int failures, double end, int samples) {
  std::mt19937_64 random(1);
  const double b10 = WeibullQuantile(kShape, kScale, 0.1);
  const char* names[] = {"Fisher", "likelihood ratio", "corrected (default)"};
  Tally of_b10[3], of_shape[3];
  int fitted = 0;
  const bool by_count = end == kNever;
  const FewFailures few{failures, {{static_cast<double>(units), kNever}}};
  const RootMoments quantile = QuantileRoots(few, 0.1), shape = ShapeRoots(few);
  for (int k = 0; k < samples; ++k) {
    const std::vector<Lifetime> lives = Draw(units, failures, end, random);
    if (CountLifetimes(lives).failures < 2.0) continue;
    ++fitted;
    const WeibullFit fit = FitWeibull(lives);
    BoundsSettings settings;
    settings.simulated = 400;
    // The same for all samples that end at a failure.
    if (by_count) settings.few = quantile;
    const BoundedEstimate life = BoundsOfQuantile(fit, lives, 0.1, settings);
    if (by_count) settings.few = shape;
    const BoundedEstimate form = BoundsOf(fit, lives, settings).shape;
    const Interval lives_of[] = {life.fisher, life.likelihood_ratio, life.corrected};
    const Interval shapes_of[] = {form.fisher, form.likelihood_ratio, form.corrected};
    for (int i = 0; i < 3; ++i) {
      of_b10[i].Take(lives_of[i], b10);
      of_shape[i].Take(shapes_of[i], kShape);
    }
  }
  for (int i = 0; i < 3; ++i)
    std::printf("%-34s %-20s %8.1f %8.1f %8.1f %8.1f   of %d\n", i == 0 ? what : "", names[i],
                100.0 * of_b10[i].held / fitted, 100.0 * of_b10[i].below / fitted,
                100.0 * of_shape[i].held / fitted, 100.0 * of_shape[i].below / fitted, fitted);
}

int Coverage(int samples) {
  std::printf("two-sided 90 %% intervals; truth shape 2; %d samples a row\n%-34s %-20s %8s %8s %8s %8s\n",
              samples, "", "", "B10 %", "below %", "shape %", "below %");
  Cover("3 units, all failed", 3, 3, kNever, samples);
  Cover("5 units, all failed", 5, 5, kNever, samples);
  Cover("10 units, all failed", 10, 10, kNever, samples);
  Cover("10 units to the 5th failure", 10, 5, kNever, samples);
  Cover("10 units to 0.83 of the scale", 10, 10, 0.8326 * kScale, samples / 5);
  Cover("5 units to 1.2 of the scale", 5, 5, 1.2 * kScale, samples / 5);
  Cover("20 units to 0.5 of the scale", 20, 20, 0.5 * kScale, samples / 5);
  return 0;
}

// One law, seen to one share: coverage, median width as a ratio of ends, that of a straight line's interval
// that holds as many, α–λ accuracy (within 20 % of what is left), and the median of |ln(forecast/life)|.
void ForecastRow(LifeLaw law, double share, int lives) {
  constexpr double kAlpha = 0.2;
  std::mt19937_64 random(7);
  int held = 0, early = 0, accurate = 0, none = 0;
  std::vector<double> widths, errors, errors_of_lines;
  for (int i = 0; i < lives; ++i) {
    const SimulatedLife life = DrawLife(law, random);
    const DegradationPath seen = SeenTo(life, share);
    const LimitForecast forecast = ForecastLimit(seen, 0.9);
    if (!forecast.is_approached) {
      ++none;
      continue;
    }
    held += forecast.interval.low <= life.met && life.met <= forecast.interval.high;
    early += life.met < forecast.interval.low;
    accurate += std::abs(forecast.cycle - life.met) <= kAlpha * (1.0 - share) * life.met;
    widths.push_back(std::log(forecast.interval.high / forecast.interval.low));
    errors.push_back(std::abs(std::log(forecast.cycle / life.met)));
    errors_of_lines.push_back(std::abs(std::log(StraightLineForecast(seen) / life.met)));
  }
  const auto at = [](std::vector<double>& values, std::size_t place) {
    std::sort(values.begin(), values.end());
    return values[std::min(place, values.size() - 1)];
  };
  const auto n = static_cast<double>(widths.size());
  const auto last_held = static_cast<std::size_t>(std::max(held - 1, 0));
  std::printf("%-30s %4.0f %6.1f %7.1f %8.2f %8.2f %7.1f %8.3f %8.3f %5d\n", NameOf(law), 100.0 * share,
              100.0 * held / n, 100.0 * early / n, std::exp(at(widths, widths.size() / 2)),
              std::exp(2.0 * at(errors_of_lines, last_held)), 100.0 * accurate / n,
              at(errors, errors.size() / 2), at(errors_of_lines, errors_of_lines.size() / 2), none);
}

int Forecasts(int lives) {
  std::printf("90 %% intervals of %d lives a row\n%-30s %4s %6s %7s %8s %8s %7s %8s %8s %5s\n", lives, "law",
              "at %", "held %", "early %", "width", "by line", "a-l %", "error", "by line", "none");
  for (const double share : {0.3, 0.5, 0.6, 0.7, 0.8, 0.9}) {
    for (const LifeLaw law : kFiguresOnly) ForecastRow(law, share, lives);
    for (const LifeLaw law : kChosenOn) ForecastRow(law, share, lives);
  }
  return 0;
}

// Units of one law on as many benches, all for a share of the median life.
void PopulationRow(LifeLaw law, int units, double share, int populations) {
  std::mt19937_64 random(5);
  Tally b10, b50;
  int none = 0;
  std::vector<double> widths, errors;
  for (int i = 0; i < populations; ++i) {
    const SimulatedPopulation population = DrawPopulation(law, units, random);
    const std::vector<double>& lives = population.lives;
    std::vector<DegradationPath> seen;
    for (const SimulatedLife& unit : population.units)
      seen.push_back(SeenUntil(unit, std::max(static_cast<int>(share * lives[lives.size() / 2]), 8)));
    try {
      const DegradationLife life = LifeFromDegradation(seen, {0.1, 0.5}, 0.9);
      b10.Take(life.quantiles[0].interval, lives[lives.size() / 10]);
      b50.Take(life.quantiles[1].interval, lives[lives.size() / 2]);
      const auto& [low, high] = life.quantiles[0].interval;
      widths.push_back(std::log(high / low));
      errors.push_back(std::abs(std::log(life.quantiles[0].value / lives[lives.size() / 10])));
    } catch (const NoEstimate&) {
      ++none;
    }
  }
  std::sort(widths.begin(), widths.end());
  std::sort(errors.begin(), errors.end());
  const auto n = static_cast<double>(widths.size());
  std::printf("%-30s %5d %4.0f %6.1f %7.1f %6.1f %7.1f %8.2f %8.3f %5d\n", NameOf(law), units, 100.0 * share,
              100.0 * b10.held / n, 100.0 * b10.below / n, 100.0 * b50.held / n, 100.0 * b50.below / n,
              std::exp(widths[widths.size() / 2]), errors[errors.size() / 2], none);
}

int Populations(int populations) {
  std::printf("90 %% intervals of %d populations a row\n%-30s %5s %4s %6s %7s %6s %7s %8s %8s %5s\n",
              populations, "law", "units", "at %", "B10 %", "below %", "B50 %", "below %", "width", "error",
              "none");
  for (const int units : {3, 6}) {
    for (const double share : {0.3, 0.6, 0.9}) {
      for (const LifeLaw law : kChosenOn) PopulationRow(law, units, share, populations);
      for (const LifeLaw law : kFiguresOnly) PopulationRow(law, units, share, populations);
    }
  }
  return 0;
}

int Fit(const char* file) {
  std::ifstream in(file);
  std::vector<Lifetime> lives;
  double time = 0.0;
  int status = 0;
  while (in >> time >> status)
    lives.push_back(status == 1 ? Lifetime::Failed(time) : Lifetime::Suspended(time));
  const auto begun = std::chrono::steady_clock::now();
  const WeibullFit fit = FitWeibull(lives);
  const WeibullBounds bounds = BoundsOf(fit, lives, {});
  const BoundedEstimate b10 = BoundsOfQuantile(fit, lives, 0.1, {});
  const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  std::printf("%.6f s %.8f %.8f %.8f %.8f %.8f %.8f\n", s, fit.shape, fit.scale,
              bounds.shape.likelihood_ratio.low, bounds.shape.likelihood_ratio.high, b10.likelihood_ratio.low,
              b10.likelihood_ratio.high);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "coverage") return Coverage(argc > 2 ? std::atoi(argv[2]) : 10000);
  if (what == "forecast") return Forecasts(argc > 2 ? std::atoi(argv[2]) : 200);
  if (what == "population") return Populations(argc > 2 ? std::atoi(argv[2]) : 100);
  if (what == "fit" && argc > 2) return Fit(argv[2]);
  std::fputs("life_benchmark coverage [SAMPLES] | forecast [LIVES] | population [POPULATIONS] | fit TIMES\n",
             stderr);
  return 2;
}
