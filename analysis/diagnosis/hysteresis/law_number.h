// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "analysis/diagnosis/hysteresis/effects.h"
#include "analysis/diagnosis/hysteresis/gear.h"

namespace strainwave::analysis::diagnosis {

/// One way in which a number goes into the law, the number's name, and the range in which it is believed.
struct LawForm {
  const char* name;
  const char* unit;
  double low;
  double high;
  std::function<void(double, GearLaw&)> put;
};

/// An effect of one number that goes straight into the law. Numbers: which form, where there are several; the
/// amount, as a share of the form's range.
class LawNumber : public LoopEffect {
 public:
  LawNumber(CauseRule the_rule, std::vector<LawForm> forms);

  void ShapeGear(std::span<const double> v, GearLaw& law) const override;
  std::vector<std::vector<double>> Starts(const LoopResidual& residual) const override;
  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override;
  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override;

 private:
  std::size_t Amount() const { return numbers.size() - 1; }
  const LawForm& FormOf(std::span<const double> v) const;

  std::vector<LawForm> forms_;
};

}  // namespace strainwave::analysis::diagnosis
