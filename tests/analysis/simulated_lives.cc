// SPDX-License-Identifier: Apache-2.0
#include "tests/analysis/simulated_lives.h"

#include <algorithm>
#include <cmath>

#include "analysis/model/wear.h"

namespace strainwave::analysis::reliability {
namespace {

using Random = std::mt19937_64;

double Uniform(double low, double high, Random& random) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
double Normal(Random& random) { return std::normal_distribution<double>()(random); }
double About(double value, double spread, Random& random) {
  return value * std::exp(spread * Normal(random));
}
double LogUniform(double low, double high, Random& random) {
  return std::exp(Uniform(std::log(low), std::log(high), random));
}

struct Course {
  std::vector<double> value;
  double limit{1.0};
};

constexpr double kSteps = 1000.0;  // in about one life

Course PlantWear(Random& random) {
  model::WearRates rates;
  for (double* rate : {&rates.tooth_running_in, &rates.tooth_steady, &rates.tooth_grease_coupling,
                       &rates.flexspline_start, &rates.grease_rate})
    *rate = About(*rate, 0.3, random);
  rates.tooth_late = About(rates.tooth_late, 0.5, random);
  rates.run_in_life_share = About(rates.run_in_life_share, 0.5, random);
  rates.flexspline_growth = About(rates.flexspline_growth, 0.4, random);
  model::WearEffects effects;
  for (double* effect :
       {&effects.tooth_k2, &effects.flexspline_k2, &effects.tooth_kinematic, &effects.flexspline_kinematic,
        &effects.tooth_hysteresis, &effects.grease_hysteresis})
    *effect = About(*effect, 0.3, random);
  const double torque = rates.reference_torque_Nm;
  const double revolutions = About(1.0, 0.3, random) * rates.reference_revolutions / kSteps;
  const model::WearExposure step{revolutions, torque * torque * torque * revolutions, 50.0};
  const int quantity = std::uniform_int_distribution<int>(0, 2)(random);
  const double limits[] = {0.08, 0.5, 0.4};
  Course course{{}, About(limits[quantity], 0.3, random)};
  model::WearState state;
  while (course.value.size() < 4 * static_cast<std::size_t>(kSteps) && state.tooth < 6.0 &&
         state.flexspline < 6.0) {
    model::AdvanceWear(rates, step, state);
    const model::WearFactors factors = model::FactorsOf(effects, state);
    const double values[] = {1.0 - factors.k2, factors.kinematic[1] - 1.0, factors.hysteresis - 1.0};
    course.value.push_back(values[quantity]);
  }
  return course;
}

Course Settling(Random& random) {
  const double pace = Uniform(0.5, 2.0, random) / kSteps;
  const double share = Uniform(0.2, 0.8, random);
  const double time = Uniform(0.1, 0.5, random);
  Course course;
  for (int i = 0; i < 8 * kSteps; ++i)
    course.value.push_back(share * -std::expm1(-pace * i / time) + (1.0 - share) * pace * i);
  return course;
}

Course GammaProcess(Random& law, Random& unit) {
  const double shape = Uniform(0.05, 0.5, law);
  std::gamma_distribution<double> step(shape, Uniform(0.5, 2.0, law) / (kSteps * shape));
  Course course;
  double sum = 0.0;
  for (int i = 0; i < 6 * kSteps; ++i) course.value.push_back(sum += step(unit));
  return course;
}

Course CrackGrowth(Random& random) {
  const double exponent = Uniform(2.2, 4.0, random);
  const double rate = Uniform(0.5, 2.0, random) / kSteps;
  Course course{{}, Uniform(2.0, 20.0, random)};
  double length = 1.0;
  for (int i = 0; i < 5 * kSteps && length < 20.0; ++i) {
    length += rate * std::pow(length, 0.5 * exponent);
    course.value.push_back(length * length - 1.0);  // compliance
  }
  return course;
}

Course WornLayer(Random& random) {
  const double rate = Uniform(0.5, 2.0, random) / kSteps;
  const double layer = Uniform(0.2, 0.8, random);
  const double faster = Uniform(1.5, 4.0, random);
  const double width = Uniform(0.02, 0.15, random);
  const double run_in = Uniform(0.0, 0.15, random);
  const double time = Uniform(0.02, 0.1, random) * kSteps;
  Course course;
  double wear = 0.0;
  for (int i = 0; i < 6 * kSteps && wear < 1.3; ++i) {
    wear += rate * (1.0 + (faster - 1.0) / (1.0 + std::exp((layer - wear) / width))) +
            run_in / time * std::exp(-i / time);
    course.value.push_back(wear);
  }
  return course;
}

Course Logistic(Random& random) {
  const double steepness = Uniform(3.0, 8.0, random);
  const double pace = Uniform(0.7, 1.5, random) / kSteps;
  const double centre = Uniform(0.6, 1.2, random);
  Course course{{}, Uniform(0.4, 0.8, random)};
  const double first = 1.0 / (1.0 + std::exp(steepness * centre));
  for (int i = 0; i < 6 * kSteps; ++i) {
    const double value = 1.0 / (1.0 + std::exp(steepness * (centre - pace * i)));
    course.value.push_back((value - first) / (1.0 - first));
  }
  return course;
}

// @param unit  what differs between units of the same law.
Course Draw(LifeLaw law, Random& random, Random& unit) {
  switch (law) {
    case LifeLaw::kPlantWear:
      return PlantWear(random);
    case LifeLaw::kSettling:
      return Settling(random);
    case LifeLaw::kGammaProcess:
      return GammaProcess(random, unit);
    case LifeLaw::kCrackGrowth:
      return CrackGrowth(random);
    case LifeLaw::kWornLayer:
      return WornLayer(random);
    case LifeLaw::kLogistic:
      return Logistic(random);
  }
  return {};
}

std::size_t StepMet(const Course& course) {
  return static_cast<std::size_t>(
      std::ranges::find_if(course.value, [&](double value) { return value >= course.limit; }) -
      course.value.begin());
}

bool IsUsable(const Course& course) {
  constexpr std::size_t kFewestSteps = 30;
  return StepMet(course) >= kFewestSteps && StepMet(course) < course.value.size();
}

struct Noise {
  double white{};
  double drift{};
  double memory{};  // of the drift, per cycle
};

Noise DrawNoise(Random& random) {
  const double white = LogUniform(0.003, 0.05, random);
  const double drift = LogUniform(0.001, 0.02, random);
  return {white, drift, Uniform(0.5, 0.97, random)};
}

// Cycles from steps as fine as the law was solved.
SimulatedLife LifeOf(const Course& course, double steps_a_cycle, const Noise& noise, Random& random) {
  SimulatedLife life;
  double drifted = 0.0;
  for (int cycle = 1;; ++cycle) {
    const double step = steps_a_cycle * (cycle - 1);
    const auto before = static_cast<std::size_t>(step);
    if (before + 1 >= course.value.size()) break;
    const double part = step - static_cast<double>(before);
    const double value =
        (course.value[before] + part * (course.value[before + 1] - course.value[before])) / course.limit;
    if (value >= 1.0 && life.met == 0) life.met = cycle;
    drifted = noise.memory * drifted + std::sqrt(1.0 - noise.memory * noise.memory) * Normal(random);
    life.seen.cycle.push_back(cycle);
    life.seen.way.push_back(value + noise.white * Normal(random) + noise.drift * drifted);
  }
  if (life.met == 0) life.met = static_cast<int>(life.seen.cycle.size()) + 1;
  // From the mean of the first cycles on, as a campaign reads it.
  double first = 0.0;
  constexpr std::size_t kFirst = 5;
  for (std::size_t i = 0; i < kFirst; ++i) first += life.seen.way[i] / static_cast<double>(kFirst);
  for (double& way : life.seen.way) way = (way - first) / (1.0 - first);
  return life;
}

}  // namespace

const char* NameOf(LifeLaw law) {
  switch (law) {
    case LifeLaw::kPlantWear:
      return "wear of the simulated plant";
    case LifeLaw::kSettling:
      return "settling, then straight";
    case LifeLaw::kGammaProcess:
      return "gamma process";
    case LifeLaw::kCrackGrowth:
      return "crack growth (Paris)";
    case LifeLaw::kWornLayer:
      return "hardened layer worn through";
    case LifeLaw::kLogistic:
      return "logistic";
  }
  return "";
}

SimulatedLife DrawLife(LifeLaw law, Random& random) {
  Course course = Draw(law, random, random);
  while (!IsUsable(course)) course = Draw(law, random, random);
  const double cycles = std::floor(LogUniform(60.0, 1500.0, random));
  const Noise noise = DrawNoise(random);
  return LifeOf(course, static_cast<double>(StepMet(course)) / cycles, noise, random);
}

SimulatedPopulation DrawPopulation(LifeLaw law, int units, Random& random) {
  constexpr int kForTruth = 1001;
  const std::uint64_t seed = random();
  std::uint64_t attempt = 0;
  const auto draw = [&] {
    Random of_law(seed + attempt);
    return Draw(law, of_law, random);
  };
  while (!IsUsable(draw())) ++attempt;
  SimulatedPopulation population;
  population.log_deviation = Uniform(0.05, 0.5, random);
  const double cycles = LogUniform(60.0, 1500.0, random);
  const double steps_a_cycle = static_cast<double>(StepMet(draw())) / cycles;
  const Noise noise = DrawNoise(random);
  for (int i = 0; i < kForTruth; ++i) {
    const double met = law == LifeLaw::kGammaProcess || i == 0 ? static_cast<double>(StepMet(draw()))
                                                               : cycles * steps_a_cycle;
    population.lives.push_back(met / steps_a_cycle * std::exp(population.log_deviation * Normal(random)));
  }
  std::ranges::sort(population.lives);
  for (int i = 0; i < units; ++i)
    population.units.push_back(
        LifeOf(draw(), steps_a_cycle * std::exp(population.log_deviation * Normal(random)), noise, random));
  return population;
}

DegradationPath SeenTo(const SimulatedLife& life, double share) {
  return SeenUntil(life, static_cast<int>(share * life.met));
}

DegradationPath SeenUntil(const SimulatedLife& life, int cycle) {
  const auto count = std::min(static_cast<std::ptrdiff_t>(cycle), std::ssize(life.seen.cycle));
  return {{life.seen.cycle.begin(), life.seen.cycle.begin() + count},
          {life.seen.way.begin(), life.seen.way.begin() + count}};
}

}  // namespace strainwave::analysis::reliability
