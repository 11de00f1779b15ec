// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "analysis/diagnosis/hysteresis/effects.h"

namespace strainwave::analysis::diagnosis {

/// A shape without a physical cause. Its numbers are its parameters as they are, in their units.
class NuisanceTerm : public LoopEffect {
 public:
  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override {
    const std::vector<double> se = ErrorsOf(covariance);
    std::vector<ParameterValue> described;
    for (std::size_t k = 0; k < names_.size(); ++k) described.push_back({names_[k], units_[k], v[k], se[k]});
    return described;
  }
  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override {
    std::vector<double> v;
    for (const std::string& name : names_) v.push_back(RequireParameter(rule, parameters, name));
    return v;
  }

 protected:
  void Number(const std::string& name, const std::string& unit, const FitNumber& number) {
    names_.push_back(name);
    units_.push_back(unit);
    numbers.push_back(number);
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::string> units_;
};

/// A bell of height 1: 0 at its middle, ±1 where it is half as high. Beyond 10⁻¹¹ of it there is none, which
/// saves most of the time of a narrow one.
inline double Bell(double from_middle) {
  return std::abs(from_middle) < 6.0 ? std::exp(-std::numbers::ln2 * from_middle * from_middle) : 0.0;
}

/// Appends knees of the spring that lie elsewhere than the record says.
void AppendKneeNuisanceTerm(const LoopRecords& records, LoopEffects& effects);
/// Appends a jump and a window in time.
void AppendTimeNuisanceTerms(const LoopRecords& records, LoopEffects& effects);
/// Appends windows over torque and over output angle.
void AppendPositionNuisanceTerms(const LoopRecords& records, LoopEffects& effects);

}  // namespace strainwave::analysis::diagnosis
