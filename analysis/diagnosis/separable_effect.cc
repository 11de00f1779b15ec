// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/separable_effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>
#include <utility>

#include "analysis/decompositions.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr int kMostDraws = 200;
constexpr double kSlopeAgrees = 0.01;  // of an amount that is twice as large at twice the coefficients

const ParameterValue* Find(std::span<const ParameterValue> values, std::string_view name) {
  const auto found = std::ranges::find(values, name, &ParameterValue::name);
  return found == values.end() ? nullptr : &*found;
}

// One draw: coefficients of a small effect, and nonlinear parameters.
class DrawnTerm {
 public:
  DrawnTerm(const SeparableTerm& term, const CauseRule& rule, std::size_t samples, double small,
            std::mt19937_64& random)
      : term_(term), rule_(rule), columns_(static_cast<Index>(samples), static_cast<Index>(term.columns)) {
    boost::random::uniform_01<double> uniform;
    boost::random::normal_distribution<double> normal;
    numbers_.assign(term.columns, 0.0);
    for (const NonlinearParameterRange& range : term.nonlinear_parameters)
      numbers_.push_back(range.low + uniform(random) * (range.high - range.low));
    ForgetNumbersOfRecord();
    term.fill(std::span<const double>(numbers_).subspan(term.columns), columns_);
    for (std::size_t c = 0; c < term.columns; ++c) {
      const double size =
          columns_.col(static_cast<Index>(c)).norm() / std::sqrt(static_cast<double>(samples));
      numbers_[c] = size > 0.0 ? small * normal(random) / size : 0.0;
    }
    const Index width = static_cast<Index>(numbers_.size());
    covariance_ = Eigen::MatrixXd::Zero(width, width);
    const SymmetricParts gram = SymmetricEigen(columns_.transpose() * columns_);
    const Eigen::VectorXd inverse = gram.InverseAbove(1e-12 * std::max(gram.values.maxCoeff(), 1e-300));
    covariance_.topLeftCorner(columns_.cols(), columns_.cols()) =
        gram.vectors * inverse.asDiagonal() * gram.vectors.transpose();
  }

  std::vector<ParameterValue> Described(double factor) const {
    std::vector<double> numbers = numbers_;
    for (std::size_t c = 0; c < term_.columns; ++c) numbers[c] *= factor;
    return term_.describe(numbers, covariance_);
  }
  bool IsWithinRanges() const {
    const std::vector<ParameterValue> values = Described(1.0);
    return std::ranges::all_of(rule_.parameters, [&](const ParameterRule& rule) {
      const ParameterValue* value = Find(values, rule.name);
      return value == nullptr || rule.amount || (value->value >= rule.low && value->value <= rule.high);
    });
  }
  // The name of the number that says how large it is; empty where none does.
  std::string Amount() const {
    const std::vector<ParameterValue> once = Described(1.0);
    const std::vector<ParameterValue> twice = Described(2.0);
    const auto grows = [&](const std::string& name) {
      const ParameterValue* one = Find(once, name);
      const ParameterValue* two = Find(twice, name);
      return one != nullptr && two != nullptr && !one->of_record && one->value != 0.0 &&
             std::abs(two->value / one->value - 2.0) < kSlopeAgrees;
    };
    for (const ParameterRule& rule : rule_.parameters)
      if (rule.amount && grows(rule.name)) return rule.name;
    for (const ParameterValue& value : once)
      if (grows(value.name)) return value.name;
    return {};
  }
  std::optional<DrawnEffect> Effect(const std::string& amount) const {
    ParameterValue value = *Find(Described(1.0), amount);
    DrawnEffect effect{amount, value.unit, kUnlimited, {}};
    const auto rule = std::ranges::find(rule_.parameters, amount, &ParameterRule::name);
    if (rule != rule_.parameters.end()) {
      if (rule->low >= 0.0 ? value.value < 0.0 : rule->high <= 0.0 && value.value > 0.0) value.value *= -1.0;
      const double end = value.value > 0.0 ? rule->high : -rule->low;
      if (!(end > 0.0)) return std::nullopt;
      effect.largest_amount = std::min(end, kUnlimited);
    }
    const double sign = value.value * Find(Described(1.0), amount)->value < 0.0 ? -1.0 : 1.0;
    const Eigen::Map<const Eigen::VectorXd> coefficients(numbers_.data(), columns_.cols());
    const Eigen::VectorXd added = columns_ * coefficients * (sign / std::abs(value.value));
    if (!added.allFinite() || added.squaredNorm() == 0.0) return std::nullopt;
    effect.added = [added](double size) -> Eigen::VectorXd { return size * added; };
    return effect;
  }

 private:
  void ForgetNumbersOfRecord() {
    std::vector<double> values;
    bool any = false;
    const auto width = static_cast<Index>(numbers_.size());
    for (const ParameterValue& value : term_.describe(numbers_, Eigen::MatrixXd::Zero(width, width))) {
      values.push_back(value.of_record ? 0.0 : value.value);
      any = any || value.of_record;
    }
    if (!any) return;
    const std::vector<double> forgotten = term_.restore(values);
    std::copy(forgotten.begin() + static_cast<std::ptrdiff_t>(term_.columns), forgotten.end(),
              numbers_.begin() + static_cast<std::ptrdiff_t>(term_.columns));
  }

  const SeparableTerm& term_;
  const CauseRule& rule_;
  std::vector<double> numbers_;
  Eigen::MatrixXd columns_;
  Eigen::MatrixXd covariance_;
};

}  // namespace

std::optional<DrawnEffect> DrawSeparableEffect(const SeparableTerm& term, const CauseRule& rule,
                                               std::size_t samples, double small, std::uint64_t draw) {
  std::seed_seq seed{static_cast<std::uint32_t>(draw), static_cast<std::uint32_t>(draw >> 32U)};
  std::mt19937_64 random(seed);
  for (int tried = 0; tried < kMostDraws; ++tried) {
    const DrawnTerm one(term, rule, samples, small, random);
    if (!one.IsWithinRanges()) continue;
    const std::string amount = one.Amount();
    if (amount.empty()) continue;
    if (std::optional<DrawnEffect> effect = one.Effect(amount)) return effect;
  }
  return std::nullopt;
}

std::unique_ptr<Study> SeparableStudy::WithResponse(std::span<const double> measured) const {
  if (measured.size() != model_.measured.size()) {
    throw std::invalid_argument(fmt::format("a response of {} samples for records of {} (expected as many)",
                                            measured.size(), model_.measured.size()));
  }
  auto other = std::make_unique<SeparableStudy>(*this);
  other->model_.measured.assign(measured.begin(), measured.end());
  return other;
}

std::optional<DrawnEffect> SeparableStudy::DrawEffect(std::size_t cause, const ModelFit& /*beside*/,
                                                      std::uint64_t draw) const {
  double square = 0.0;
  for (const double value : model_.measured) square += value * value;
  const auto samples = model_.measured.size();
  const double small = 1e-6 * std::sqrt(square / static_cast<double>(samples));
  return DrawSeparableEffect(model_.causes[cause], model_.rules[cause], samples, small, draw);
}

}  // namespace strainwave::analysis::diagnosis
