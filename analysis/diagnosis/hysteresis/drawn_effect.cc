// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/drawn_effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

#include "analysis/diagnosis/hysteresis/model.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr int kMostEffectDraws = 200;
constexpr double kOfRange = 1e-3;  // a small amount, for slopes at zero

// The number of a rule that says how large its effect is.
const ParameterRule& AmountOf(const CauseRule& rule) {
  const auto amount = std::ranges::find(rule.parameters, true, &ParameterRule::amount);
  return amount == rule.parameters.end() ? rule.parameters.front() : *amount;
}

std::vector<ParameterValue> Described(const LoopEffect& effect, const std::vector<double>& numbers) {
  const auto count = static_cast<Eigen::Index>(numbers.size());
  return effect.Describe(numbers, Eigen::MatrixXd::Zero(count, count));
}

// With amounts that are small.
std::vector<double> DrawNumbers(const LoopEffect& effect, std::mt19937_64& random) {
  boost::random::uniform_01<double> uniform;
  boost::random::normal_distribution<double> normal;
  std::vector<double> numbers;
  for (const FitNumber& number : effect.numbers) {
    const double share = uniform(random);
    const double size = normal(random);
    if (!number.amount)
      numbers.push_back(number.low + share * (number.high - number.low));
    else
      numbers.push_back(kOfRange * number.high * (number.low < 0.0 ? size : std::abs(size)));
  }
  return numbers;
}

bool KeepsItsRanges(const LoopEffect& effect, const std::vector<ParameterValue>& values) {
  return std::ranges::all_of(effect.rule.parameters, [&](const ParameterRule& rule) {
    const double* value = FindParameter(values, rule.name);
    return value == nullptr || (*value >= rule.low && *value <= rule.high);
  });
}

// The numbers of the effects of a fit but for one, and of that one where they are given.
struct Placed {
  LoopModel model;
  Eigen::VectorXd numbers;
};
Placed Place(const LoopRecords& records, const LoopEffects& effects, const ModelFit& beside,
             std::size_t cause, std::span<const double> own) {
  std::vector<const LoopEffect*> before;
  for (const std::size_t other : beside.causes) before.push_back(effects.at(other).get());
  const LoopModel fitted(records, before);
  const Eigen::Map<const Eigen::VectorXd> state(beside.state.data(),
                                                static_cast<Eigen::Index>(beside.state.size()));
  const Eigen::VectorXd old = state;
  std::vector<double> numbers(old.data(), old.data() + fitted.nominal_size());
  std::vector<const LoopEffect*> now;
  for (std::size_t e = 0; e < before.size(); ++e) {
    if (beside.causes[e] == cause) continue;
    now.push_back(before[e]);
    const std::span<const double> of = fitted.Of(e, old);
    numbers.insert(numbers.end(), of.begin(), of.end());
  }
  if (!own.empty()) {
    now.push_back(effects.at(cause).get());
    numbers.insert(numbers.end(), own.begin(), own.end());
  }
  return {LoopModel(records, std::move(now)),
          Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()))};
}

}  // namespace

std::optional<DrawnEffect> DrawLoopEffect(const LoopRecords& records, const LoopEffects& effects,
                                          std::size_t cause, const ModelFit& beside, std::uint64_t draw) {
  const LoopEffect& effect = *effects.at(cause);
  if (effect.rule.parameters.empty()) return std::nullopt;
  const ParameterRule& amount = AmountOf(effect.rule);
  std::seed_seq seed{static_cast<std::uint32_t>(draw), static_cast<std::uint32_t>(draw >> 32U)};
  std::mt19937_64 random(seed);
  for (int tried = 0; tried < kMostEffectDraws; ++tried) {
    const std::vector<double> numbers = DrawNumbers(effect, random);
    const std::vector<ParameterValue> values = Described(effect, numbers);
    const double* size = FindParameter(values, amount.name);
    if (size == nullptr || *size == 0.0 || !std::isfinite(*size) || !KeepsItsRanges(effect, values)) continue;
    DrawnEffect drawn{amount.name, amount.unit, *size > 0.0 ? amount.high : -amount.low, {}};
    drawn.added = [&records, &effects, cause, beside, numbers,
                   once = std::abs(*size)](double asked) -> Eigen::VectorXd {
      std::vector<double> own = numbers;
      const std::vector<FitNumber>& ranges = effects.at(cause)->numbers;
      for (std::size_t k = 0; k < own.size(); ++k)
        if (ranges[k].amount) own[k] *= asked / once;
      const Placed without = Place(records, effects, beside, cause, {});
      const Placed with = Place(records, effects, beside, cause, own);
      return with.model.Predict(with.numbers, records.samples) -
             without.model.Predict(without.numbers, records.samples);
    };
    return drawn;
  }
  return std::nullopt;
}

std::vector<HysteresisData> WithAngles(std::span<const HysteresisData> records,
                                       std::span<const double> output_angle_rad) {
  std::vector<HysteresisData> others(records.begin(), records.end());
  std::size_t samples = 0;
  for (const HysteresisData& record : records) samples += record.output_angle_rad.size();
  if (samples != output_angle_rad.size()) {
    throw std::invalid_argument(fmt::format("a response of {} samples for records of {} (expected as many)",
                                            output_angle_rad.size(), samples));
  }
  std::size_t first = 0;
  for (HysteresisData& record : others) {
    for (double& angle_rad : record.output_angle_rad) angle_rad = output_angle_rad[first++];
  }
  return others;
}

}  // namespace strainwave::analysis::diagnosis
