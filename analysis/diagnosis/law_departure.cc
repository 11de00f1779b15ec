// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/law_departure.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/QR>

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr int kMostPower = 3;

// What the model's parameters are, each to be moved by itself.
struct Parameters {
  std::vector<ParameterValue> nominal;
  std::vector<Study::NamedCause> causes;
};

Parameters ParametersOf(const Study& study, const ModelFit& fit) {
  Parameters all{fit.nominal, {}};
  for (std::size_t i = 0; i < fit.causes.size(); ++i)
    all.causes.push_back({study.causes()[fit.causes[i]].name, fit.cause_parameters[i]});
  return all;
}

VectorXd Rooted(std::span<const double> weights) {
  VectorXd roots(static_cast<Index>(weights.size()));
  for (Index i = 0; i < roots.size(); ++i) roots(i) = std::sqrt(weights[static_cast<std::size_t>(i)]);
  return roots;
}

// By differences of one standard error, columns weighted.
MatrixXd TangentsOf(const Study& study, const Parameters& at, const VectorXd& predicted,
                    const VectorXd& roots) {
  std::vector<VectorXd> columns;
  const auto move = [&](Parameters& moved, ParameterValue& value) {
    if (!(value.standard_error > 0.0) || !std::isfinite(value.standard_error)) return;
    value.value += value.standard_error;
    const VectorXd change = (study.Predict(moved.nominal, moved.causes) - predicted).cwiseProduct(roots);
    value.value -= value.standard_error;
    if (change.allFinite() && change.squaredNorm() > 0.0) columns.push_back(change);
  };
  Parameters moved = at;
  for (ParameterValue& value : moved.nominal) move(moved, value);
  for (Study::NamedCause& cause : moved.causes) {
    for (ParameterValue& value : cause.parameters) move(moved, value);
  }
  MatrixXd tangents(predicted.size(), static_cast<Index>(columns.size()));
  for (Index k = 0; k < tangents.cols(); ++k) tangents.col(k) = columns[static_cast<std::size_t>(k)];
  return tangents;
}

// From −1 at the smallest to 1 at the largest; nothing of what does not change.
std::optional<VectorXd> ToUnitRange(std::span<const double> values) {
  const auto [low, high] = std::ranges::minmax(values);
  if (!(high > low)) return std::nullopt;
  VectorXd unit(static_cast<Index>(values.size()));
  for (Index i = 0; i < unit.size(); ++i)
    unit(i) = std::clamp(2.0 * (values[static_cast<std::size_t>(i)] - low) / (high - low) - 1.0, -1.0, 1.0);
  return unit;
}

MatrixXd TimesPolynomials(const VectorXd& contribution, const VectorXd& unit) {
  MatrixXd columns(contribution.size(), kMostPower);
  for (int power = 1; power <= kMostPower; ++power) {
    columns.col(power - 1) = contribution.cwiseProduct(
        unit.unaryExpr([power](double x) { return std::legendre(static_cast<unsigned>(power), x); }));
  }
  return columns;
}

// A linear spline of its own size in the place of each value.
MatrixXd SplineOfSize(const VectorXd& contribution) {
  constexpr int kKnots = 5;  // at even shares of the samples
  std::vector<double> sizes(contribution.cwiseAbs().begin(), contribution.cwiseAbs().end());
  std::ranges::sort(sizes);
  std::vector<double> knots;
  for (int k = 0; k < kKnots; ++k)
    knots.push_back(sizes[(sizes.size() - 1) * static_cast<std::size_t>(k) / (kKnots - 1)]);
  MatrixXd columns = MatrixXd::Zero(contribution.size(), kKnots);
  for (Index i = 0; i < contribution.size(); ++i) {
    const double size = std::abs(contribution(i));
    const auto next =
        std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(knots, size) - knots.begin(), 1, kKnots - 1);
    const double from = knots[static_cast<std::size_t>(next - 1)];
    const double width = knots[static_cast<std::size_t>(next)] - from;
    const double part = width > 0.0 ? std::min((size - from) / width, 1.0) : 1.0;
    const double sign = contribution(i) < 0.0 ? -1.0 : 1.0;
    columns(i, next - 1) = sign * (1.0 - part);
    columns(i, next) = sign * part;
  }
  return columns;
}

// First and second differences within each segment.
MatrixXd Differences(const VectorXd& contribution, std::span<const std::size_t> segments) {
  MatrixXd columns = MatrixXd::Zero(contribution.size(), 2);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const auto first = static_cast<Index>(segments[s]);
    const auto last = s + 1 < segments.size() ? static_cast<Index>(segments[s + 1]) : contribution.size();
    for (Index i = first + 1; i + 1 < last; ++i) {
      columns(i, 0) = 0.5 * (contribution(i + 1) - contribution(i - 1));
      columns(i, 1) = contribution(i + 1) - 2.0 * contribution(i) + contribution(i - 1);
    }
  }
  return columns;
}

class Residual {
 public:
  Residual(VectorXd weighted, const MatrixXd& tangents, VectorXd roots)
      : weighted_(std::move(weighted)), roots_(std::move(roots)) {
    if (tangents.cols() > 0) basis_ = Orthonormal(tangents);
    weighted_ = Beside(weighted_);
  }

  // What `columns` take beside the tangents: sum of squares, and the fitted change beside them.
  std::pair<double, VectorXd> Take(const MatrixXd& columns) const {
    const MatrixXd beside = Beside(roots_.asDiagonal() * columns);
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(beside);
    const VectorXd coefficients = qr.solve(weighted_);
    const double left = (weighted_ - beside * coefficients).squaredNorm();
    return {weighted_.squaredNorm() - left, beside * coefficients};
  }

 private:
  static MatrixXd Orthonormal(const MatrixXd& columns) {
    Eigen::ColPivHouseholderQR<MatrixXd> qr(columns.colwise().normalized());
    qr.setThreshold(1e-8);
    const MatrixXd q = qr.householderQ() * MatrixXd::Identity(columns.rows(), qr.rank());
    return q;
  }
  MatrixXd Beside(const MatrixXd& columns) const {
    if (basis_.cols() == 0) return columns;
    return columns - basis_ * (basis_.transpose() * columns);
  }

  VectorXd weighted_;
  VectorXd roots_;
  MatrixXd basis_;
};

}  // namespace

std::optional<LawDeparture> LargestLawDeparture(const Study& study, std::span<const double> weights,
                                                const ModelFit& fit, std::size_t cause,
                                                double most_relative_size) {
  const auto place = std::ranges::find(fit.causes, cause) - fit.causes.begin();
  const Parameters parameters = ParametersOf(study, fit);
  const auto& own = parameters.causes[static_cast<std::size_t>(place)];
  VectorXd contribution;
  MatrixXd tangents;
  const VectorXd roots = Rooted(weights);
  try {
    contribution = study.Predict(fit.nominal, std::span(&own, 1)) - study.Predict(fit.nominal, {});
    tangents = TangentsOf(study, parameters, study.Predict(parameters.nominal, parameters.causes), roots);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
  const VectorXd weighted_contribution = contribution.cwiseProduct(roots);
  if (!contribution.allFinite() || !(weighted_contribution.squaredNorm() > 0.0)) return std::nullopt;
  const std::span<const double> measured = study.measured();
  const VectorXd residual = VectorXd::Map(measured.data(), fit.predicted.size()) - fit.predicted;
  const Residual beside(residual.cwiseProduct(roots), tangents, roots);

  std::optional<LawDeparture> largest;
  const auto look = [&](const std::string& over, const MatrixXd& columns) {
    const auto [explained, change] = beside.Take(columns);
    const double relative = std::sqrt(change.squaredNorm() / weighted_contribution.squaredNorm());
    if (relative > most_relative_size || (largest && explained <= largest->explained)) return;
    largest = LawDeparture{over, explained, relative};
  };
  for (const Regressor& regressor : study.regressors()) {
    if (regressor.name == "direction" || regressor.values.size() != measured.size()) continue;
    if (const auto unit = ToUnitRange(regressor.values))
      look(regressor.name, TimesPolynomials(contribution, *unit));
  }
  look("its size", SplineOfSize(contribution));
  look("time lag", Differences(contribution, study.segments()));
  return largest;
}

}  // namespace strainwave::analysis::diagnosis
