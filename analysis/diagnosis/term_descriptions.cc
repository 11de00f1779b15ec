// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/separable_study.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {

void DescribeAsHarmonic(SeparableTerm& term, std::string amplitude_name, std::string unit, double unit_per_si,
                        std::vector<NonlinearParameterDescription> nonlinear_parameters) {
  const std::string prefix = amplitude_name.find("amplitude") == std::string::npos
                                 ? std::string{}
                                 : amplitude_name.substr(0, amplitude_name.find("amplitude"));
  term.describe = [=](std::span<const double> numbers, const Eigen::MatrixXd& covariance) {
    const double a = numbers[0];
    const double b = numbers[1];
    const double amplitude = std::hypot(a, b);
    Eigen::Vector2d along(1.0, 0.0);
    if (amplitude > 0.0) along = Eigen::Vector2d(a, b) / amplitude;
    const Eigen::Vector2d across(-along(1), along(0));
    const Eigen::Matrix2d block = covariance.topLeftCorner<2, 2>();
    const double phase_error =
        amplitude > 0.0 ? std::min(StandardErrorOf(across.dot(block * across)) / amplitude, kTwoPi / 2.0)
                        : kTwoPi / 2.0;
    std::vector<ParameterValue> values{
        {amplitude_name, unit, amplitude * unit_per_si,
         StandardErrorOf(along.dot(block * along)) * unit_per_si},
        {prefix + "phase_deg", "deg", DegFromRad(std::atan2(b, a)), DegFromRad(phase_error)}};
    for (std::size_t s = 0; s < nonlinear_parameters.size(); ++s) {
      const auto i = static_cast<Eigen::Index>(2 + s);
      values.push_back({nonlinear_parameters[s].name, nonlinear_parameters[s].unit,
                        numbers[2 + s] * nonlinear_parameters[s].unit_per_si,
                        StandardErrorOf(covariance(i, i)) * nonlinear_parameters[s].unit_per_si});
    }
    return values;
  };
  term.restore = [=](std::span<const double> values) {
    const double amplitude = values[0] / unit_per_si;
    const double phase = RadFromDeg(values[1]);
    std::vector<double> numbers{amplitude * std::cos(phase), amplitude * std::sin(phase)};
    for (std::size_t s = 0; s < nonlinear_parameters.size(); ++s)
      numbers.push_back(values[2 + s] / nonlinear_parameters[s].unit_per_si);
    return numbers;
  };
}

void DescribeEach(SeparableTerm& term, std::vector<NonlinearParameterDescription> descriptions) {
  term.describe = [=](std::span<const double> numbers, const Eigen::MatrixXd& covariance) {
    std::vector<ParameterValue> values;
    for (std::size_t i = 0; i < descriptions.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const double factor = descriptions[i].unit_per_si;
      values.push_back({descriptions[i].name, descriptions[i].unit, numbers[i] * factor,
                        StandardErrorOf(covariance(row, row)) * std::abs(factor)});
    }
    return values;
  };
  term.restore = [=](std::span<const double> values) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < descriptions.size(); ++i)
      numbers.push_back(values[i] / descriptions[i].unit_per_si);
    return numbers;
  };
}

}  // namespace strainwave::analysis::diagnosis
