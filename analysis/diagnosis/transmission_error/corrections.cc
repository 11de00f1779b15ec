// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <optional>
#include <utility>

#include "analysis/diagnosis/residual_views.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/diagnosis/transmission_error/terms.h"
#include "analysis/harmonic_regression.h"
#include "analysis/model/local_tooth_damage.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Samples = TransmissionErrorSamples;

// Orders per output turn that a ripple within a segment may have.
double HighestOrderInSegment(const Samples& samples) {
  if (samples.samples_per_turn > 0.0) return 0.5 * samples.samples_per_turn;
  const double turns =
      std::max(SpanOf(samples.output_rad), 1e-9) / kTwoPi * static_cast<double>(samples.records);
  return std::min(400.0, 0.4 * static_cast<double>(samples.output_rad.size()) / turns);
}

// Orders per output turn that a sweep tells apart. Uneven steps fold none, but each order more is one more to
// look at.
double HighestOrder(const Samples& samples) {
  return samples.samples_per_turn > 0.0 ? 0.5 * samples.samples_per_turn : kHighestOrderPerTurn;
}

SeparableTerm LineTerm(std::shared_ptr<const std::vector<double>> angle,
                       const NonlinearParameterRange& order) {
  SeparableTerm term;
  term.columns = 2;
  term.nonlinear_parameters = {order};
  term.fill = [angle](std::span<const double> nonlinear_parameters, Eigen::Ref<Eigen::MatrixXd> design) {
    for (std::size_t i = 0; i < angle->size(); ++i) {
      design(static_cast<Eigen::Index>(i), 0) = std::cos(nonlinear_parameters[0] * (*angle)[i]);
      design(static_cast<Eigen::Index>(i), 1) = std::sin(nonlinear_parameters[0] * (*angle)[i]);
    }
  };
  DescribeAsHarmonic(term, "amplitude_arcmin", "arcmin", kArcminPerRad,
                     {{"order_per_output_turn", "1", 1.0}});
  return term;
}

// A line of any order over an angle.
void AddFreeLine(const Samples& samples, SeparableModel& model, const std::string& which) {
  const double top = HighestOrder(samples);
  const double lowest = 0.6;
  const double cell = kTwoPi / std::max(SpanOf(samples.output_rad), 1e-9);
  auto angle = std::make_shared<const std::vector<double>>(samples.output_rad);
  SeparableTerm term = LineTerm(angle, {0.5 * lowest, top, 0.3 * cell});
  term.starts = [angle, lowest, top](const WeightedResidual& residual) {
    std::vector<std::vector<double>> starts;
    for (const LinePeak& peak : FindLines(*angle, residual.values, residual.weights, lowest, top, 1)) {
      starts.push_back({std::clamp(peak.order, 0.5 * lowest, top)});
    }
    return starts;
  };
  term.log_search_locations = [lowest, top](std::span<const double> nonlinear_parameters) {
    return LogSearchLocationsOfLine(nonlinear_parameters[0], lowest, top);
  };
  DescribeAsHarmonic(term, "amplitude_arcmin", "arcmin", kArcminPerRad,
                     {{"order_per_output_turn", "1", 1.0}});
  model.causes.push_back(std::move(term));
  model.rules.push_back({.name = which,
                         .parameters = {{"amplitude_arcmin", "arcmin", 0.0, 1e6, true}},
                         .degrees_of_freedom = 3,
                         .location_parameters = 1,
                         .trials_factor = IndependentOrders(samples.output_rad, lowest, top),
                         .named = false});
}

// A line at one of the whole orders that mechanics makes, beyond the named ones: fewer search locations, so
// that a weaker one is seen.
void AddWholeOrderLine(const Samples& samples, SeparableModel& model) {
  const double top = HighestOrder(samples);
  std::vector<double> orders;
  for (double order = 3.0; order <= 8.0 && order < top; order += 1.0) orders.push_back(order);
  for (const double order : {3.0, 5.0, 6.0, 8.0}) {
    const double per_turn = order * std::abs(samples.ratio);
    orders.push_back(samples.samples_per_turn > 0.0 ? FoldedOrder(per_turn, samples.samples_per_turn)
                                                    : per_turn);
  }
  std::erase_if(orders, [](double order) { return order < 2.5; });
  if (orders.empty()) return;
  const double cell = kTwoPi / std::max(SpanOf(samples.output_rad), 1e-9);
  auto angle = std::make_shared<const std::vector<double>>(samples.output_rad);
  SeparableTerm term = LineTerm(angle, {.low = 1.0,
                                        .high = *std::ranges::max_element(orders) + 1.0,
                                        .step = 0.3 * cell,
                                        .moved = Moved::kNever});
  term.starts = [angle, orders](const WeightedResidual& residual) {
    double best_drop = 0.0;
    double best = 0.0;
    for (const double order : orders) {
      const double drop = LineDrop(*angle, residual.values, residual.weights, order);
      if (drop > best_drop) best = order;
      best_drop = std::max(best_drop, drop);
    }
    return best > 0.0 ? std::vector<std::vector<double>>{{best}} : std::vector<std::vector<double>>{};
  };
  model.causes.push_back(std::move(term));
  model.rules.push_back({.name = "line at a whole order",
                         .parameters = {{"amplitude_arcmin", "arcmin", 0.0, 1e6, true}},
                         .degrees_of_freedom = 2,
                         .trials_factor = static_cast<double>(orders.size()),
                         .named = false});
}

// Search locations in window and order at which a ripple may be, of all widths an octave apart: windows of a
// turn times orders that one of them tells apart.
double CellsOfTurn(double narrowest_rad, double widest_rad, double top) {
  return std::max(1.0, (std::log2(widest_rad / narrowest_rad) + 1.0) * (top - 3.0));
}

// A segment of the turn and an order that is strong in it.
struct LocalRipple {
  double centre_rad{};
  double width_rad{};
  double order{};
  double drop{};  // of the sum of squares
};

// The strongest of all windows (widths an octave apart, centres a quarter of a width) and orders (half of
// what a window tells apart), a few that differ.
std::vector<LocalRipple> FindRipples(std::span<const double> turn_angle, const WeightedResidual& residual,
                                     double narrowest_rad, double widest_rad, double top) {
  constexpr double kFewest = 4.0;  // samples' weight in a window
  constexpr std::size_t kKept = 3;
  const auto bins = static_cast<std::size_t>(std::clamp(8.0 * top, 720.0, 3600.0));
  const double bin_rad = kTwoPi / static_cast<double>(bins);
  std::vector<double> weight(bins, 0.0);
  std::vector<double> sum(bins, 0.0);
  double all = 0.0;
  double mean = 0.0;
  for (std::size_t i = 0; i < turn_angle.size(); ++i) {
    const auto bin = std::min(bins - 1, static_cast<std::size_t>(turn_angle[i] / bin_rad));
    weight[bin] += residual.weights[i];
    sum[bin] += residual.weights[i] * residual.values[i];
    all += residual.weights[i];
    mean += residual.weights[i] * residual.values[i];
  }
  mean /= std::max(all, 1e-300);
  std::vector<LocalRipple> found;
  std::vector<double> weight_to(bins + 1, 0.0);  // of the bins below each
  std::vector<std::complex<double>> line_to(bins + 1);
  for (std::size_t b = 0; b < bins; ++b) weight_to[b + 1] = weight_to[b] + weight[b];
  for (double width = narrowest_rad; width < widest_rad * 1.01; width *= 2.0) {
    const double resolved = kTwoPi / width;
    const auto reach = static_cast<std::size_t>(width / bin_rad);
    for (double order = std::max(3.0, resolved); order <= top; order += 0.5 * resolved) {
      const std::complex<double> turned = std::polar(1.0, -order * bin_rad);
      std::complex<double> line = 1.0;
      for (std::size_t b = 0; b < bins; ++b) {
        line_to[b + 1] = line_to[b] + (sum[b] - mean * weight[b]) * line;
        line *= turned;
      }
      for (std::size_t first = 0; first + reach <= bins; first += std::max<std::size_t>(1, reach / 4)) {
        const double inside = weight_to[first + reach] - weight_to[first];
        if (inside < kFewest) continue;
        const double centre = (static_cast<double>(first) + 0.5 * static_cast<double>(reach)) * bin_rad;
        found.push_back(
            {centre, width, order, 2.0 * std::norm(line_to[first + reach] - line_to[first]) / inside});
      }
    }
  }
  std::sort(found.begin(), found.end(),
            [](const LocalRipple& a, const LocalRipple& b) { return a.drop > b.drop; });
  std::vector<LocalRipple> kept;
  for (const LocalRipple& ripple : found) {
    if (kept.size() == kKept) break;
    const bool close = std::any_of(kept.begin(), kept.end(), [&](const LocalRipple& other) {
      return std::abs(std::remainder(ripple.centre_rad - other.centre_rad, kTwoPi)) < other.width_rad &&
             std::abs(ripple.order - other.order) < kTwoPi / other.width_rad;
    });
    if (!close) kept.push_back(ripple);
  }
  return kept;
}

// What has less than half a period in its window is a bump, and a damaged tooth's.
double OrderOfRipple(double order, double width_rad) { return std::max(order, 0.5 * kTwoPi / width_rad); }

// A line that is there in one segment of the turn only.
void AddRippleInWindow(const Samples& samples, SeparableModel& model) {
  std::vector<double> turn_angle(samples.output_rad);
  for (double& angle : turn_angle) angle -= kTwoPi * std::floor(angle / kTwoPi);
  const double narrowest = RadFromDeg(8.0);
  const double widest = RadFromDeg(120.0);
  const double top = HighestOrderInSegment(samples);
  SeparableTerm term;
  term.columns = 2;
  term.nonlinear_parameters = {{-0.5, kTwoPi + 0.5, RadFromDeg(4.0)},
                               {0.5 * narrowest, 1.5 * widest, RadFromDeg(4.0)},
                               {3.0, top, 1.0}};
  term.fill = [turn_angle](std::span<const double> nonlinear_parameters, Eigen::Ref<Eigen::MatrixXd> design) {
    const double order = OrderOfRipple(nonlinear_parameters[2], nonlinear_parameters[1]);
    for (std::size_t i = 0; i < turn_angle.size(); ++i) {
      const double inside =
          model::LocalToothDamageShape(turn_angle[i], nonlinear_parameters[0], nonlinear_parameters[1]);
      design(static_cast<Eigen::Index>(i), 0) = inside * std::cos(order * turn_angle[i]);
      design(static_cast<Eigen::Index>(i), 1) = inside * std::sin(order * turn_angle[i]);
    }
  };
  term.starts = [turn_angle, narrowest, widest, top](const WeightedResidual& residual) {
    std::vector<std::vector<double>> starts;
    for (const LocalRipple& ripple : FindRipples(turn_angle, residual, narrowest, widest, top)) {
      starts.push_back({ripple.centre_rad, ripple.width_rad, ripple.order});
    }
    return starts;
  };
  DescribeAsHarmonic(term, "amplitude_arcmin", "arcmin", kArcminPerRad,
                     {{"centre_deg", "deg", DegFromRad(1.0)},
                      {"width_deg", "deg", DegFromRad(1.0)},
                      {"order_per_output_turn", "1", 1.0}});
  term.describe = [as_they_are = term.describe](std::span<const double> fitted,
                                                const Eigen::MatrixXd& covariance) {
    std::vector<double> numbers(fitted.begin(), fitted.end());
    numbers[4] = OrderOfRipple(numbers[4], numbers[3]);
    return as_they_are(numbers, covariance);
  };
  model.causes.push_back(std::move(term));
  model.rules.push_back({.name = "ripple in a window of output angle",
                         .parameters = {{"amplitude_arcmin", "arcmin", 0.0, 1e6, true}},
                         .degrees_of_freedom = 5,
                         .location_parameters = 3,
                         .trials_factor = std::max(1.0, 0.25 * CellsOfTurn(narrowest, widest, top)),
                         .local = true,
                         .named = false});
}

// Another level in a segment of a quantity: wider than a damaged tooth, with sharp ends.
void AddLevelInWindow(SeparableModel& model, const std::vector<double>& values, double narrowest,
                      NonlinearParameterDescription from, NonlinearParameterDescription to,
                      std::string name) {
  constexpr double kWidest = 0.9;  // of all
  const double span = SpanOf(values);
  if (!(span > 2.0 * narrowest)) return;
  const auto [low, high] = std::ranges::minmax(values);
  SeparableTerm term;
  term.nonlinear_parameters = {{.low = low - span, .high = high, .step = narrowest, .moved = Moved::kNever},
                               {.low = low, .high = high + span, .step = narrowest, .moved = Moved::kNever}};
  term.fill = [values](std::span<const double> nonlinear_parameters, Eigen::Ref<Eigen::MatrixXd> design) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const bool inside = values[i] >= nonlinear_parameters[0] && values[i] < nonlinear_parameters[1];
      design(static_cast<Eigen::Index>(i), 0) = inside ? 1.0 : 0.0;
    }
  };
  term.starts = [values, narrowest, span](const WeightedResidual& residual) {
    std::vector<std::vector<double>> starts;
    for (const WindowPeak& peak :
         FindSharpWindows(values, residual.values, residual.weights, narrowest, kWidest * span, 3))
      starts.push_back({peak.centre - 0.5 * peak.width, peak.centre + 0.5 * peak.width});
    return starts;
  };
  term.log_search_locations = [narrowest, span](std::span<const double> nonlinear_parameters) {
    return LogSearchLocationsOfWidth(nonlinear_parameters[1] - nonlinear_parameters[0], narrowest,
                                     kWidest * span);
  };
  DescribeEach(term, {{"level_arcmin", "arcmin", kArcminPerRad}, std::move(from), std::move(to)});
  model.causes.push_back(std::move(term));
  model.rules.push_back({.name = std::move(name),
                         .parameters = {{"level_arcmin", "arcmin", -1e6, 1e6, true}},
                         .degrees_of_freedom = 3,
                         .location_parameters = 2,
                         // Both ends are sharp, and each may be at any sample: of 225 clean records a
                         // fortieth had p < 0.05 with a sixth of these, where a three-hundredth should.
                         .trials_factor = 72.0 * span / narrowest,
                         .local = true,
                         .named = false});
}

constexpr Eigen::Index kPowers = 4;

// Powers of a quantity, from −1 at its smallest value to 1 at its largest; nothing of one that stands still.
std::optional<SeparableTerm> CurveTerm(const std::vector<double>& values) {
  if (values.empty() || !(SpanOf(values) > 0.0)) return std::nullopt;
  const auto [low, high] = std::ranges::minmax(values);
  const double middle = 0.5 * (low + high);
  const double half = 0.5 * (high - low);
  SeparableTerm term;
  term.columns = kPowers;
  term.fill = [values, middle, half](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      double power = 1.0;
      for (Eigen::Index j = 0; j < kPowers; ++j)
        design(static_cast<Eigen::Index>(i), j) = power *= (values[i] - middle) / half;
    }
  };
  std::vector<NonlinearParameterDescription> numbers;
  for (Eigen::Index k = 1; k <= kPowers; ++k)
    numbers.push_back({fmt::format("power_{}_arcmin", k), "arcmin", kArcminPerRad});
  DescribeEach(term, std::move(numbers));
  return term;
}

void AddCurve(SeparableModel& model, const std::vector<double>& values, std::string name) {
  std::optional<SeparableTerm> term = CurveTerm(values);
  if (!term) return;
  model.causes.push_back(std::move(*term));
  model.rules.push_back(
      {.name = std::move(name), .degrees_of_freedom = static_cast<int>(kPowers), .named = false});
}

}  // namespace

void AddCurveOfDrift(const TransmissionErrorSamples& samples, CauseRule rule, SeparableModel& model) {
  std::optional<SeparableTerm> term = CurveTerm(samples.time_s);
  if (!term) return;
  model.causes.push_back(std::move(*term));
  rule.parameters = {{"power_1_arcmin", "arcmin", -kLargest_arcmin, kLargest_arcmin, false}};
  rule.degrees_of_freedom = static_cast<int>(kPowers);
  model.rules.push_back(std::move(rule));
}

void AddTransmissionErrorNuisanceTerms(const TransmissionErrorSamples& samples, SeparableModel& model) {
  AddFreeLine(samples, model, "line over output angle");
  AddFreeLine(samples, model, "second line over output angle");
  AddWholeOrderLine(samples, model);
  AddRippleInWindow(samples, model);
  std::vector<double> turn_angle(samples.output_rad);
  for (double& angle : turn_angle) angle -= kTwoPi * std::floor(angle / kTwoPi);
  AddLevelInWindow(model, turn_angle, RadFromDeg(15.0), {"from_deg", "deg", DegFromRad(1.0)},
                   {"to_deg", "deg", DegFromRad(1.0)}, "level in a window of output angle");
  const char* const unit = samples.has_time ? "s" : "samples";
  AddLevelInWindow(model, samples.time_s, SpanOf(samples.time_s) / 40.0,
                   {fmt::format("from_{}", unit), unit, 1.0}, {fmt::format("to_{}", unit), unit, 1.0},
                   "level in a window of time");
  if (!TimeIsApartFromAngle(samples)) AddCurve(model, samples.time_s, "curve over time");
  AddCurve(model, samples.torque_Nm, "curve over torque");
}

}  // namespace strainwave::analysis::diagnosis
