// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/gear_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "analysis/diagnosis/vibration/chance.h"
#include "analysis/diagnosis/vibration/line_sets.h"
#include "analysis/model/vibration_orders.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kLeastOfSet = 4.0;      // −ln p of known lines together
constexpr double kPartOfLineCell = 0.3;  // that tells two lines apart
constexpr double kScalesACell = 12.0;    // standard errors to both sides, and some between
constexpr int kMostMultiple = 3;
constexpr int kMostSpeedPower = 3;  // of a line's gain over the speed

struct MeshOrders {
  std::array<double, 2> first_two{};
  std::vector<double> others;  // none of them twice

  std::vector<double> all() const {
    std::vector<double> orders(first_two.begin(), first_two.end());
    orders.insert(orders.end(), others.begin(), others.end());
    return orders;
  }
};

MeshOrders OrdersOf(const VibrationSamples& samples) {
  MeshOrders orders{
      {model::FlexsplineMeshOrder(samples.ratio), model::CircularSplineMeshOrder(samples.ratio)}, {}};
  const double output = 1.0 / std::abs(samples.ratio);
  const double apart = kPartOfLineCell / samples.shortest_turns();
  const auto add = [&](double order) {
    const auto is_near = [&](double other) { return std::abs(other - order) < apart; };
    if (std::ranges::none_of(orders.first_two, is_near) && std::ranges::none_of(orders.others, is_near))
      orders.others.push_back(order);
  };
  for (int multiple = 1; multiple <= kMostMultiple; ++multiple) {
    if (multiple > 1 && multiple * orders.first_two[1] > samples.highest_order()) break;
    for (const double first : orders.first_two) {
      const double centre = multiple * first;
      add(centre);
      for (const double sideband : {-2.0, -1.0, 1.0, 2.0}) add(centre + sideband);
      if (samples.shortest_turns() * output < 0.5) continue;
      for (const double sideband : {-output, output}) add(centre + sideband);
    }
  }
  return orders;
}

double OrderOf(const LineOrder& line) { return line.harmonic + line.offset; }

// A mesh without either of its own orders is none.
bool HasItsOwn(const MeshOrders& orders, const VibrationTerm& mesh) {
  return std::ranges::any_of(mesh.lines, [&](const LineOrder& line) {
    return std::ranges::any_of(orders.first_two, [&](double first) {
      const double multiple = OrderOf(line) / first;
      return std::abs(multiple - std::round(multiple)) < 1e-9;
    });
  });
}

// Those of the orders that are together least likely to be noise: either or both of the first two, and the
// strongest of the others, each for the choice that there is. Nothing where noise does as well.
std::vector<double> LikeliestSet(const VibrationResidual& residual, const MeshOrders& orders, double scale) {
  const auto channels = static_cast<double>(residual.over_turns().channels());
  std::vector<std::pair<double, double>> others;  // power, order
  for (const double order : orders.others) others.emplace_back(PowerAt(residual, scale * order), order);
  std::ranges::sort(others, std::greater<>());
  const double powers[] = {PowerAt(residual, scale * orders.first_two[0]),
                           PowerAt(residual, scale * orders.first_two[1])};
  double most = kLeastOfSet;
  std::vector<double> best;
  for (const unsigned mask : {1U, 2U, 3U}) {
    std::vector<double> chosen;
    double sum = 0.0;
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
      if ((mask >> k & 1U) == 0) continue;
      chosen.push_back(orders.first_two[k]);
      sum += powers[k];
    }
    double choice = 0.0;
    for (std::size_t more = 0;; ++more) {
      const double excess = ExcessOf(sum, channels * static_cast<double>(chosen.size())) - choice;
      if (excess > most) {
        most = excess;
        best = chosen;
      }
      if (more == others.size() || chosen.size() == kMostLines) break;
      sum += others[more].first;
      chosen.push_back(others[more].second);
      choice = LogChoices(more + 1, others.size());
    }
  }
  return best;
}

bool SpeedChanges(const VibrationSamples& samples) {
  return std::ranges::any_of(samples.runs,
                             [](const VibrationRun& run) { return run.speed_spread > kLeastSpeedSpread; });
}

// The same lines with gains that follow the speed, as far as they pay.
std::optional<TermFit> WithGainsOverSpeed(const VibrationResidual& residual, const TermFit& fit) {
  VibrationTerm term = fit.term;
  for (int power = 1; power <= kMostSpeedPower; ++power) {
    for (const LineOrder& line : fit.term.lines) {
      if (term.lines.size() < 2 * kMostLines) term.lines.push_back({line.harmonic, line.offset, power});
    }
  }
  TermFit found = residual.WithAllChannels(std::move(term), 0);
  while (found.term.lines.size() > fit.term.lines.size()) {
    const std::vector<double> gains = LineGains(found);
    const auto first = gains.begin() + static_cast<std::ptrdiff_t>(fit.term.lines.size());
    const auto worst = std::min_element(first, gains.end());
    if (*worst > 0.0) return found;
    VibrationTerm fewer = found.term;
    fewer.lines.erase(fewer.lines.begin() + (worst - gains.begin()));
    found = residual.WithAllChannels(std::move(fewer), 0);
  }
  return std::nullopt;
}

// The scales of the angle that the shaft's lines leave open.
double LogScales(const VibrationSamples& samples) {
  const double order = model::FlexsplineMeshOrder(samples.ratio);
  return std::log1p(kScalesACell * samples.order_uncertainty * order * samples.shortest_turns());
}

}  // namespace

std::optional<TermFit> SearchGearMesh(const VibrationResidual& residual, std::size_t index) {
  const VibrationSamples& samples = residual.samples();
  const MeshOrders orders = OrdersOf(samples);
  LeastLikelyChance best(residual);
  const bool speed_changes = SpeedChanges(samples);
  const auto take = [&](TermFit fit) {
    if (!HasItsOwn(orders, fit.term)) return;
    if (speed_changes) {
      if (std::optional<TermFit> following = WithGainsOverSpeed(residual, fit)) {
        const double log_choices = LogChoicesOfMesh(samples, following->term);
        best.Take(std::move(*following), log_choices);
      }
    }
    const double log_choices = LogChoicesOfMesh(samples, fit.term);
    best.Take(std::move(fit), log_choices);
  };
  for (const bool open : {false, true}) {
    if (open && !ScaleIsOpen(samples, orders.first_two[0])) break;
    VibrationTerm term = LinesTerm(residual, index);
    if (open) term.nonlinear_parameters = {BestScale(residual, {orders.first_two[0], orders.first_two[1]})};
    const auto lines_of = [&](const std::vector<double>& chosen) {
      std::vector<LineOrder> lines;
      std::ranges::transform(chosen, std::back_inserter(lines), [&](double order) {
        return open ? LineOrder{order, 0.0} : LineOrder{0.0, order};
      });
      return lines;
    };
    // Lines that stand out each for itself; or a few weak ones that do together, in all channels.
    if (std::optional<TermFit> own = FitPayingLines(residual, term, lines_of(orders.all()), 1))
      take(std::move(*own));
    const std::vector<double> first_two(orders.first_two.begin(), orders.first_two.end());
    for (const std::vector<double>& chosen :
         {LikeliestSet(residual, orders, open ? term.nonlinear_parameters[0] : 1.0), first_two}) {
      if (chosen.empty()) break;
      term.lines = lines_of(chosen);
      const int rounds = open ? 5 : 0;
      TermFit fit = residual.WithAllChannels(term, rounds);
      take(fit);
      if (samples.channels() > 1) take(residual.WithoutUnobservable(std::move(fit)));
    }
  }
  return std::move(best).fit();
}

double LogChoicesOfMesh(const VibrationSamples& samples, const VibrationTerm& mesh) {
  const MeshOrders orders = OrdersOf(samples);
  const auto follows_speed = [](const LineOrder& line) { return line.speed_power > 0; };
  const auto is_further = [&](const LineOrder& line) {
    return line.speed_power == 0 && std::ranges::none_of(orders.first_two, [&](double first) {
             return std::abs(first - OrderOf(line)) < 1e-9;
           });
  };
  const auto further = static_cast<std::size_t>(std::ranges::count_if(mesh.lines, is_further));
  const auto observable = static_cast<std::size_t>(std::ranges::count(mesh.observable, 1));
  const auto following = static_cast<std::size_t>(std::ranges::count_if(mesh.lines, follows_speed));
  const std::size_t may_follow = kMostSpeedPower * (mesh.lines.size() - following);
  return LogChoices(further, orders.others.size()) + LogChoices(following, may_follow) +
         LogChoices(observable, samples.channels()) +
         (mesh.nonlinear_parameters.empty() ? 0.0 : LogScales(samples));
}

}  // namespace strainwave::analysis::diagnosis
