// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/diagnosis/hysteresis/effects.h"

namespace strainwave::analysis::diagnosis {

/// One way in which an effect may go, with its amount's name.
struct Form {
  const char* name;
  const char* unit;
  double unit_per_number;                      // the number as people read it over the fit's own
  double nonlinear_parameter_per_number{1.0};  // the shape's number over e to the fit's own
};

/// Adds amount × a shape that depends on one more number, in one of several forms. Numbers: form, amount, ln
/// of the shape's number; derived classes may have more behind them.
class FormedEffect : public LoopEffect {
 public:
  FormedEffect(const LoopRecords& records, std::vector<Form> forms, const char* size_name,
               const char* nonlinear_parameter_name, const char* nonlinear_parameter_unit);

  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override;
  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override;
  bool IsHeld(std::span<const double> v, std::size_t k) const override {
    return k == 0 || (k == 2 && !HasNonlinearParameter(v[0]));
  }
  int NonlinearParameter() const override { return 2; }

 protected:
  virtual bool HasNonlinearParameter(double /*form*/) const { return true; }
  /// What the effect adds to the angle, arcmin rms, beyond what a straight spring and friction could do as
  /// well.
  double SizeOf(std::span<const double> v) const;

  const LoopRecords& records_;
  std::vector<Form> forms_;
  const char* size_name_;
  const char* nonlinear_parameter_name_;
  const char* nonlinear_parameter_unit_;
};

/// Appends the slip of the brake that locks the input.
void AppendBrakeSlip(const LoopRecords& records, LoopEffects& effects);

}  // namespace strainwave::analysis::diagnosis
