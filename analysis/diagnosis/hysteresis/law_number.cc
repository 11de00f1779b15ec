// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/law_number.h"

#include <cmath>
#include <utility>

namespace strainwave::analysis::diagnosis {

LawNumber::LawNumber(CauseRule the_rule, std::vector<LawForm> forms) : forms_(std::move(forms)) {
  rule = std::move(the_rule);
  for (const LawForm& form : forms_)
    rule.parameters.push_back({form.name, form.unit, form.low, form.high, true});
  if (forms_.size() > 1) numbers.push_back({0.0, static_cast<double>(forms_.size() - 1), 0.0, true, false});
  // A fit may go a little beyond what is believed, so that a number at the edge has an error.
  numbers.push_back({forms_.front().low < 0.0 ? -1.2 : 0.0, 1.2, 1e-6, false, true});
  shapes_gear = true;
}

const LawForm& LawNumber::FormOf(std::span<const double> v) const {
  return forms_[Amount() == 0 ? 0 : static_cast<std::size_t>(std::lround(v[0]))];
}

void LawNumber::ShapeGear(std::span<const double> v, GearLaw& law) const {
  const LawForm& form = FormOf(v);
  form.put(v[Amount()] * form.high, law);
}

std::vector<std::vector<double>> LawNumber::Starts(const LoopResidual&) const {
  if (forms_.size() == 1) return {{0.0}};
  std::vector<std::vector<double>> starts;
  for (std::size_t form = 0; form < forms_.size(); ++form) starts.push_back({static_cast<double>(form), 0.0});
  return starts;
}

std::vector<ParameterValue> LawNumber::Describe(std::span<const double> v,
                                                const Eigen::MatrixXd& covariance) const {
  const LawForm& form = FormOf(v);
  return {{form.name, form.unit, v[Amount()] * form.high, ErrorsOf(covariance)[Amount()] * form.high}};
}

std::vector<double> LawNumber::Restore(std::span<const ParameterValue> parameters) const {
  for (std::size_t f = 1; f < forms_.size(); ++f) {
    if (const double* value = FindParameter(parameters, forms_[f].name))
      return {static_cast<double>(f), *value / forms_[f].high};
  }
  std::vector<double> v(numbers.size());
  v[Amount()] = RequireParameter(rule, parameters, forms_.front().name) / forms_.front().high;
  return v;
}

}  // namespace strainwave::analysis::diagnosis
