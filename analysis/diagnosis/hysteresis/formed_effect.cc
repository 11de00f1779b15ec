// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/formed_effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {

FormedEffect::FormedEffect(const LoopRecords& records, std::vector<Form> forms, const char* size_name,
                           const char* nonlinear_parameter_name, const char* nonlinear_parameter_unit)
    : records_(records),
      forms_(std::move(forms)),
      size_name_(size_name),
      nonlinear_parameter_name_(nonlinear_parameter_name),
      nonlinear_parameter_unit_(nonlinear_parameter_unit) {}

std::vector<ParameterValue> FormedEffect::Describe(std::span<const double> v,
                                                   const Eigen::MatrixXd& covariance) const {
  const std::vector<double> se = ErrorsOf(covariance);
  const Form& form = forms_[static_cast<std::size_t>(std::lround(v[0]))];
  std::vector<ParameterValue> described{
      {form.name, form.unit, v[1] * form.unit_per_number, se[1] * form.unit_per_number}};
  if (HasNonlinearParameter(v[0])) {
    const double nonlinear_parameter = form.nonlinear_parameter_per_number * std::exp(v[2]);
    described.push_back({nonlinear_parameter_name_, nonlinear_parameter_unit_, nonlinear_parameter,
                         nonlinear_parameter * se[2]});
  }
  // Amount and shape go together in their errors: what both make of the record is known better than either.
  const double size = SizeOf(v);
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(covariance.rows());
  for (std::size_t k = 1; k < v.size() && se[k] > 0.0; ++k) {
    std::vector<double> there(v.begin(), v.end());
    there[k] += numbers[k].step;
    slope(static_cast<Eigen::Index>(k)) = (SizeOf(there) - size) / numbers[k].step;
  }
  described.push_back({size_name_, "arcmin", size, StandardErrorOf(slope.dot(covariance * slope))});
  return described;
}

std::vector<double> FormedEffect::Restore(std::span<const ParameterValue> parameters) const {
  for (std::size_t f = 0; f < forms_.size(); ++f) {
    const double* amount = FindParameter(parameters, forms_[f].name);
    if (amount == nullptr) continue;
    const auto form = static_cast<double>(f);
    const double nonlinear_parameter =
        HasNonlinearParameter(form) ? RequireParameter(rule, parameters, nonlinear_parameter_name_) : 1.0;
    return {form, *amount / forms_[f].unit_per_number,
            std::log(std::max(nonlinear_parameter, 1e-9) / forms_[f].nonlinear_parameter_per_number)};
  }
  std::string names;
  for (const Form& form : forms_) names += fmt::format("{}{}", names.empty() ? "" : ", ", form.name);
  throw std::invalid_argument(fmt::format("{} has none of the parameters {}", rule.name, names));
}

double FormedEffect::SizeOf(std::span<const double> v) const {
  const LoopGrid& grid = records_.samples;
  const auto n = static_cast<Eigen::Index>(grid.size());
  Eigen::MatrixXd ordinary(n, 3);
  ordinary.col(0).setOnes();
  ordinary.col(1) = Eigen::Map<const Eigen::VectorXd>(grid.torque_Nm.data(), n) / records_.peak_torque_Nm;
  ordinary.col(2) = Eigen::Map<const Eigen::VectorXd>(grid.direction.data(), n);
  const Eigen::VectorXd gear_rad =
      records_.compliance_rad_per_Nm() * records_.peak_torque_Nm * ordinary.col(1);
  Eigen::VectorXd added = Eigen::VectorXd::Zero(n);
  Add(v, grid, gear_rad, added);
  const Eigen::Matrix3d normal = ordinary.transpose() * ordinary;
  added -= ordinary * normal.ldlt().solve(ordinary.transpose() * added).eval();
  return ArcminFromRad(std::sqrt(added.squaredNorm() / static_cast<double>(n)));
}

std::vector<double> ErrorsOf(const Eigen::MatrixXd& covariance) {
  std::vector<double> errors;
  for (const double variance : covariance.diagonal()) errors.push_back(StandardErrorOf(variance));
  return errors;
}

const double* FindParameter(std::span<const ParameterValue> parameters, std::string_view name) {
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const ParameterValue& parameter) { return parameter.name == name; });
  return found == parameters.end() ? nullptr : &found->value;
}

double RequireParameter(const CauseRule& rule, std::span<const ParameterValue> parameters,
                        std::string_view name) {
  const double* value = FindParameter(parameters, name);
  if (value == nullptr) throw std::invalid_argument(fmt::format("{} has no parameter {}", rule.name, name));
  return *value;
}

}  // namespace strainwave::analysis::diagnosis
