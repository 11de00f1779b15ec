// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/open_numbers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr double kUnchanged = 1e-9;  // of a number: rounding

// The length of a step that changes a number by about as much as it is, so that also what is curved (an
// amplitude whose one component is not seen) shows that it changes.
double StepAlong(const Eigen::VectorXd& direction, const Eigen::VectorXd& numbers) {
  double step = 0.0;
  for (Index i = 0; i < direction.size(); ++i)
    if (direction(i) != 0.0) step = std::max(step, std::abs(numbers(i) / direction(i)));
  return step > 0.0 ? step : 1.0;
}

}  // namespace

void OpenNumbers::Mark(const Eigen::VectorXd& numbers, Index first, const DescribeNumbers& describe,
                       std::vector<ParameterValue>& described) {
  std::vector<double> changes(described.size(), 0.0);
  for (Index d = 0; d < directions_.cols(); ++d) {
    const Eigen::VectorXd direction = directions_.col(d).segment(first, numbers.size());
    if (direction.isZero(0.0)) continue;
    const double step = StepAlong(direction, numbers);
    const std::vector<ParameterValue> moved = describe(numbers + step * direction);
    for (std::size_t i = 0; i < described.size(); ++i) {
      const double change = moved[i].value - described[i].value;
      if (std::abs(change) > kUnchanged * std::max(std::abs(moved[i].value), std::abs(described[i].value)))
        changes[i] = change / step;
    }
  }
  for (std::size_t i = 0; i < described.size(); ++i) {
    if (changes[i] == 0.0) continue;
    open_.push_back({described[i], changes[i]});
    described[i].standard_error = std::numeric_limits<double>::infinity();
  }
}

std::vector<std::string> OpenNumbers::Words() const {
  if (open_.empty()) return {};
  std::vector<std::string> names;
  for (const Open& open : open_) names.push_back(open.number.name);
  if (open_.size() == 1) return {fmt::format("the records say nothing of {}", names.front())};
  if (open_.size() == 2 && directions_.cols() == 1 && open_[0].number.unit == open_[1].number.unit) {
    // What the direction leaves as it is: the errors of the two are one number's, so that they add up.
    const double times = -open_[0].change / open_[1].change;
    if (std::abs(std::abs(times) - 1.0) < kUnchanged) {
      const ParameterValue& a = open_[0].number;
      const ParameterValue& b = open_[1].number;
      return {fmt::format("the records do not tell {} from {}: known is {} {} {} = {:.4g} ± {:.2g} {}",
                          a.name, b.name, a.name, times > 0.0 ? '+' : '-', b.name, a.value + times * b.value,
                          a.standard_error + b.standard_error, a.unit)};
    }
  }
  return {fmt::format("the records do not tell apart, or say nothing of: {}", fmt::join(names, ", "))};
}

}  // namespace strainwave::analysis::diagnosis
