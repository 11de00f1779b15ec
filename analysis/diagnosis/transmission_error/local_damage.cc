// SPDX-License-Identifier: Apache-2.0
// Damage of a tooth: a bump in a window of the output's angle, on both flanks or on one.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/diagnosis/transmission_error/terms.h"
#include "analysis/model/local_tooth_damage.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// What the sample that has most of a damage has of it: of a bump as narrow as the steps nobody knows how high
// it is in between, yet this is known well. Numbers: height, centre, width, skew.
ParameterValue SeenOfDamage(std::span<const double> turn_angle, std::span<const double> numbers,
                            const Eigen::MatrixXd& covariance) {
  const auto nonlinear_parameter = [&](double at_rad, std::span<const double> v) {
    return v[0] * model::LocalToothDamageShape(at_rad, v[1], v[2], v[3]);
  };
  const double at_rad = *std::ranges::max_element(
      turn_angle, {}, [&](double here_rad) { return std::abs(nonlinear_parameter(here_rad, numbers)); });
  Eigen::Vector4d slope;
  for (std::size_t k = 0; k < 4; ++k) {
    const double step = k == 0 ? 1e-3 * std::abs(numbers[0]) : 1e-3 * std::max(numbers[2], 1e-6);
    std::vector<double> up(numbers.begin(), numbers.end());
    std::vector<double> down(up);
    up[k] += step;
    down[k] -= step;
    slope(static_cast<Eigen::Index>(k)) =
        (nonlinear_parameter(at_rad, up) - nonlinear_parameter(at_rad, down)) / (2.0 * step);
  }
  const double error = StandardErrorOf(slope.dot(covariance.topLeftCorner<4, 4>() * slope));
  return {"seen_arcmin", "arcmin", kArcminPerRad * nonlinear_parameter(at_rad, numbers),
          kArcminPerRad * error};
}

// Which flank of the tooth is damaged: one alone is felt in one direction.
enum class Flank { kBoth, kClockwise, kCounterclockwise };

std::string SentenceOfDamage(Flank flank) {
  const std::string bump = "a bump that stays within a few degrees of the output: a tooth is damaged there";
  if (flank == Flank::kBoth) return bump;
  return bump +
         (flank == Flank::kClockwise ? ", on the flank that turns cw" : ", on the flank that turns ccw");
}

std::string HeightOfDamage(Flank flank) {
  return flank == Flank::kBoth        ? "height_arcmin"
         : flank == Flank::kClockwise ? "height_cw_arcmin"
                                      : "height_ccw_arcmin";
}

void AddLocalDamage(const TransmissionErrorSamples& samples, Flank flank, SeparableModel& model) {
  std::vector<double> turn_angle(samples.output_rad);
  for (double& angle : turn_angle) angle -= kTwoPi * std::floor(angle / kTwoPi);
  const double density =
      static_cast<double>(turn_angle.size()) / std::min(kTwoPi, std::max(SpanOf(samples.output_rad), 1e-9));
  const double narrowest = std::max(RadFromDeg(0.5), 2.5 / density);
  const double widest = RadFromDeg(12.0);
  // What one sample shows may be an outlier, but not where other passes show it again.
  const double least = TimeIsApartFromAngle(samples) ? 0.0 : 0.7 * narrowest;
  SeparableTerm term;
  constexpr double kMostSkew = 0.7;
  term.nonlinear_parameters = {
      {-0.5, kTwoPi + 0.5, RadFromDeg(1.0)},
      {0.5 * narrowest, 1.5 * widest, RadFromDeg(1.0)},
      {.low = -kMostSkew, .high = kMostSkew, .step = 0.2, .moved = Moved::kForErrors}};
  std::vector<double> felt;
  for (const double direction : samples.direction)
    felt.push_back(flank == Flank::kBoth || (flank == Flank::kClockwise) == (direction > 0.0));
  term.fill = [turn_angle, felt](std::span<const double> nonlinear_parameters,
                                 Eigen::Ref<Eigen::MatrixXd> design) {
    for (std::size_t i = 0; i < turn_angle.size(); ++i) {
      design(static_cast<Eigen::Index>(i), 0) =
          felt[i] * model::LocalToothDamageShape(turn_angle[i], nonlinear_parameters[0],
                                                 nonlinear_parameters[1], nonlinear_parameters[2]);
    }
  };
  term.starts = [turn_angle, felt, narrowest, widest](const WeightedResidual& residual) {
    std::vector<double> weights(residual.weights.begin(), residual.weights.end());
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= felt[i];
    std::vector<std::vector<double>> starts;
    for (const WindowPeak& peak : FindWindows(turn_angle, residual.values, weights, narrowest, widest, 4)) {
      starts.push_back({peak.centre, std::clamp(0.8 * peak.width, 0.6 * narrowest, widest), 0.0});
    }
    return starts;
  };
  const std::string height = HeightOfDamage(flank);
  DescribeEach(term, {{height, "arcmin", kArcminPerRad},
                      {"centre_deg", "deg", DegFromRad(1.0)},
                      {"width_deg", "deg", DegFromRad(1.0)},
                      {"skew_share", "1", 1.0}});
  term.describe = [turn_angle, as_they_are = term.describe](std::span<const double> numbers,
                                                            const Eigen::MatrixXd& covariance) {
    std::vector<ParameterValue> values = as_they_are(numbers, covariance);
    values.push_back(SeenOfDamage(turn_angle, numbers, covariance));
    return values;
  };
  model.causes.push_back(std::move(term));
  model.rules.push_back({.name = "local_tooth_damage",
                         .what_to_do = "look at the teeth at the angle named, clean them, and sweep again",
                         .sentence = SentenceOfDamage(flank),
                         .where = Where::kUnit,
                         .effect = "E24",
                         .parameters = {{height, "arcmin", -kLargest_arcmin, kLargest_arcmin, false},
                                        {"seen_arcmin", "arcmin", -kLargest_arcmin, kLargest_arcmin, true},
                                        {"width_deg", "deg", DegFromRad(least), 14.0, false}},
                         .degrees_of_freedom = 3,
                         .location_parameters = 2,
                         .trials_factor = std::max(1.0, 0.5 * kTwoPi / std::max(narrowest, RadFromDeg(2.0))),
                         .local = true,
                         .of_few_samples = true});
}

}  // namespace

void AddLocalDamages(const TransmissionErrorSamples& samples, SeparableModel& model) {
  AddLocalDamage(samples, Flank::kBoth, model);
  if (!(SpanOf(samples.direction) > 1.0)) return;
  AddLocalDamage(samples, Flank::kClockwise, model);
  AddLocalDamage(samples, Flank::kCounterclockwise, model);
}

}  // namespace strainwave::analysis::diagnosis
