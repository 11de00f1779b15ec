// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/simulate_motion.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <Eigen/Dense>

#include "analysis/model/axis_motion.h"
#include "analysis/model/drive_causes.h"
#include "analysis/units.h"
#include "bench/records/record_data.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
namespace model = analysis::model;
using diagnosis::ParameterValue;

// Where the friction's sign changes, as a share of the usual speed.
constexpr double kSignWidth = 1e-3;
constexpr std::size_t kWidestWindow = 100;

double MedianStep(std::span<const double> time_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    if (time_s[i] > time_s[i - 1]) steps.push_back(time_s[i] - time_s[i - 1]);
  }
  if (steps.empty()) return 1.0;
  std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2));
  return steps[steps.size() / 2];
}

// First derivatives by parabolas through a window of rows, on the stamps as they are.
struct Derivatives {
  std::vector<double> first;
  std::vector<double> second;
};
Derivatives Differentiate(std::span<const double> time_s, std::span<const double> values, std::size_t half) {
  Derivatives result;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from = i > half ? i - half : 0;
    const std::size_t to = std::min(values.size(), i + half + 1);
    const double scale = std::max(time_s[to - 1] - time_s[from], 1e-12);
    Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t k = from; k < to; ++k) {
      const double t = (time_s[k] - time_s[i]) / scale;
      const Eigen::Vector3d row(1.0, t, t * t);
      gram += row * row.transpose();
      right += row * (values[k] - values[i]);
    }
    const Eigen::Vector3d fit = gram.completeOrthogonalDecomposition().solve(right);
    result.first.push_back(fit(1) / scale);
    result.second.push_back(2.0 * fit(2) / (scale * scale));
  }
  return result;
}

// A parameter by how its name begins: its end is a unit, which differs between rotary and linear axes.
double Number(std::span<const ParameterValue> parameters, std::string_view begin) {
  const auto found = std::ranges::find_if(
      parameters, [begin](const ParameterValue& parameter) { return parameter.name.starts_with(begin); });
  return found == parameters.end() ? 0.0 : found->value;
}

// Position, speed and acceleration of one row.
struct Row {
  double position{}, velocity{}, acceleration{}, direction{};
};

double NominalTorque(std::span<const ParameterValue> nominal, const Row& row) {
  return (Number(nominal, "inertia") + Number(nominal, "mass")) * row.acceleration +
         Number(nominal, "viscous") * row.velocity + Number(nominal, "coulomb") * row.direction +
         Number(nominal, "offset");
}

bool IsFormula(const diagnosis::Study::NamedCause& cause) {
  constexpr std::string_view kFormulae[] = {"stribeck_friction", "asymmetric_friction", "quadratic_drag",
                                            "position_periodic_torque", "gravity_load"};
  return std::ranges::find(kFormulae, cause.name) != std::end(kFormulae);
}

double CauseTorque(const diagnosis::Study::NamedCause& cause, const Row& row) {
  const std::span<const ParameterValue> numbers = cause.parameters;
  if (cause.name == "stribeck_friction") {
    const double speed = Number(numbers, "stribeck_speed");
    const auto amount = std::ranges::find_if(numbers, [](const ParameterValue& parameter) {
      return parameter.name.starts_with("stribeck_") && !parameter.name.starts_with("stribeck_speed");
    });
    return (amount == numbers.end() ? 0.0 : amount->value) * row.direction *
           model::StribeckShare(row.velocity, speed, Number(numbers, "stribeck_exponent"));
  }
  if (cause.name == "asymmetric_friction") {
    return 0.5 * Number(numbers, "viscous_difference") * row.direction * row.velocity;
  }
  if (cause.name == "quadratic_drag") return model::QuadraticDrag_Nm(Number(numbers, "drag"), row.velocity);
  const double order = cause.name == "gravity_load"             ? 1.0
                       : Number(numbers, "periods_per_m") > 0.0 ? kTwoPi * Number(numbers, "periods_per_m")
                                                                : Number(numbers, "order");
  const double friction = Number(numbers, "friction_amplitude");
  if (friction > 0.0)
    return friction * row.direction *
           std::cos(order * row.position - RadFromDeg(Number(numbers, "friction_phase")));
  return Number(numbers, "amplitude") * std::cos(order * row.position - RadFromDeg(Number(numbers, "phase")));
}

double Between(std::span<const double> position, const Eigen::VectorXd& values, double at) {
  const auto next = std::upper_bound(position.begin(), position.end(), at);
  const auto last = static_cast<Eigen::Index>(position.size()) - 1;
  const auto i = std::clamp<Eigen::Index>(next - position.begin(), 1, last);
  const double low = position[static_cast<std::size_t>(i - 1)];
  const double high = position[static_cast<std::size_t>(i)];
  const double share = high > low ? std::clamp((at - low) / (high - low), 0.0, 1.0) : 0.0;
  return values(i - 1) + share * (values(i) - values(i - 1));
}

}  // namespace

std::vector<double> SimulateMotion(const daq::Record& like, const diagnosis::Study& study,
                                   std::span<const ParameterValue> nominal,
                                   std::span<const diagnosis::Study::NamedCause> causes) {
  const diagnosis::MotionData data = MotionDataOf(like);
  const auto time = std::ranges::find(study.regressors(), "time", &diagnosis::Regressor::name);
  const double step_s = MedianStep(data.time_s);
  const double row_spacing_s = std::max(step_s, MedianStep(time->values));
  const auto half = std::clamp<std::size_t>(
      static_cast<std::size_t>(std::lround(0.5 * row_spacing_s / step_s)), 2, kWidestWindow);
  const bool by_velocity = !data.velocity.empty();
  const Derivatives moved = Differentiate(data.time_s, by_velocity ? data.velocity : data.position, half);
  const std::vector<double>& velocity = by_velocity ? data.velocity : moved.first;
  const std::vector<double>& acceleration = by_velocity ? moved.first : moved.second;
  double square = 0.0;
  for (const double value : velocity) square += value * value / static_cast<double>(velocity.size());
  const double width = kSignWidth * std::sqrt(square);

  std::vector<diagnosis::Study::NamedCause> formulae;
  std::vector<diagnosis::Study::NamedCause> others;
  for (const auto& cause : causes) (IsFormula(cause) ? formulae : others).push_back(cause);
  Eigen::VectorXd beside;
  // Called with all causes, so that one that is unknown here is refused.
  if (!causes.empty()) study.Predict(nominal, causes);
  if (!others.empty()) beside = study.Predict(nominal, others) - study.Predict(nominal, {});
  std::vector<double> simulated;
  for (std::size_t i = 0; i < data.time_s.size(); ++i) {
    const Row row{data.position[i], velocity[i], acceleration[i],
                  velocity[i] / std::max(std::hypot(velocity[i], width), 1e-300)};
    double torque = NominalTorque(nominal, row);
    for (const auto& cause : formulae) torque += CauseTorque(cause, row);
    if (!others.empty()) torque += Between(time->values, beside, data.time_s[i]);
    simulated.push_back(torque);
  }
  return simulated;
}

}  // namespace strainwave::bench
