// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/backlash.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/recent.h"
#include "analysis/model/axis_motion.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

// Turns of a contact's oscillation in a step of the points: a faster one leaves transients and no course.
constexpr double kFastestContact = 0.5;
// Part of a contact's deflection by which the width of a gap is not known.
constexpr double kContactEdge = 0.1;
constexpr double kContactMisfit = 0.005;  // of squares; nobody knows the law of the contact
// Of an inertia behind backlash's starts a few are polished, of gaps apart from each other (in ln gap); of
// these, those that are fitted.
constexpr double kAnotherGap = 0.3;
constexpr std::size_t kPolished = 4;
constexpr std::size_t kStarts = 2;
// Longer than an impact lasts: where the near side is light it jumps, and what a gap does otherwise drowns in
// when exactly; added up over that time it is the momentum that counts.
constexpr double kImpact_s = 0.03;
constexpr double kSearchLocations = 40.0;
constexpr double kRagged = 2.0;
constexpr double kCertain = 4.0;  // standard deviations
// Of a simplex: ln gap, friction, ln contact frequency, damping, start.
const std::vector<double> kFirstSteps{0.15, 0.15, 0.2, -0.15, 0.5};
const std::vector<double> kFineSteps{0.02, 0.03, 0.1, -0.05, 0.1};
// Tried around what was found.
constexpr int kWider = 20;           // times the step to either side
constexpr double kWiderStep = 0.01;  // in ln gap
constexpr double kFrictions[] = {0.0, 0.15, 0.3, 0.5, 0.8, 1.2, 1.8};
constexpr int kBegins = 10;             // to either side of the middle
constexpr double kContactStep = 0.125;  // radians of the contact's own oscillation that a step may be
// In ln gap, to see how far impacts may go astray.
constexpr double kAstray[] = {-0.15, -0.06, -0.02, 0.02, 0.06, 0.15};
constexpr std::size_t kRecentModelUncertainties = 8;
constexpr std::size_t kRecentSearches = 16;
constexpr double kSame = 1e-4;  // of what is left

// Deceleration by the nominal Coulomb friction of an axis that coasts.
double BrakingOf(const MotionGrid& grid) {
  return std::abs(grid.prefit(2)) / std::max(std::abs(grid.prefit(0)), 1e-300);
}

model::InertiaBehindBacklash::Numbers NumbersOf(const MotionGrid& grid,
                                                std::span<const double> nonlinear_parameters) {
  return {.gap = std::exp(nonlinear_parameters[0]),
          .friction = std::abs(nonlinear_parameters[1]) * BrakingOf(grid),
          .contact_rad_per_s = kTwoPi * std::exp(nonlinear_parameters[2]),
          .contact_damping = nonlinear_parameters[3],
          .start = nonlinear_parameters[4]};
}

// Push of the contact, per unit of the load's inertia. Where the points are denser than the contact
// needs them, over several at once.
void FillInertiaBehindBacklash(const MotionGrid& grid, const model::InertiaBehindBacklash::Numbers& numbers,
                               std::span<double> points) {
  for (const MotionGrid::Segment& segment : grid.segments) {
    model::InertiaBehindBacklash load(numbers, grid.position[segment.first], grid.velocity[segment.first]);
    const auto stride =
        static_cast<std::size_t>(std::max(1.0, kContactStep / (numbers.contact_rad_per_s * segment.step_s)));
    const std::size_t last = segment.first + segment.count - 1;
    points[segment.first] = 0.0;
    for (std::size_t before = segment.first; before < last;) {
      const std::size_t next = std::min(before + stride, last);
      const auto steps = static_cast<double>(next - before);
      const double push = load.Follow(grid.position[next], grid.velocity[next], steps * segment.step_s);
      const double rise = (push - points[before]) / steps;
      for (std::size_t i = before + 1; i < next; ++i)
        points[i] = points[before] + rise * static_cast<double>(i - before);
      points[next] = push;
      before = next;
    }
  }
}

// One where the motion accelerates for certain, else zero. At constant speed all that is known of
// acceleration is noise: a load that is held tight would feel it, and so much as a hair of play would set it
// free of that.
Eigen::ArrayXd WhereItAccelerates(const MotionGrid& grid) {
  return (grid.nominal.col(0).array().abs() > kCertain * grid.acceleration_noise).cast<double>();
}

// The best nonlinear parameters of a map, of gaps apart from each other: those that take more than the best
// of so many takes of white noise.
std::vector<std::vector<double>> Apart(const NonlinearParameterMap& map, const WeightedResidual& residual) {
  const Eigen::VectorXf roots = map.Roots(residual);
  std::vector<Index> order(static_cast<std::size_t>(roots.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, std::greater<>(), [&](Index k) { return roots(k); });
  const double least =
      std::sqrt(2.0 * std::log(static_cast<double>(order.size())) * map.MeanSquare(residual));
  std::vector<std::vector<double>> apart;
  for (const Index k : order) {
    if (apart.size() == kPolished || !(roots(k) > least)) break;
    const std::vector<double>& nonlinear_parameters = map.nonlinear_parameters()[static_cast<std::size_t>(k)];
    const auto close = [&](const std::vector<double>& other) {
      return std::abs(nonlinear_parameters[0] - other[0]) < kAnotherGap;
    };
    if (std::ranges::none_of(apart, close)) apart.push_back(nonlinear_parameters);
  }
  return apart;
}

// The best of some candidates, the given one among them.
std::vector<double> BestOf(StartSearch& search, const std::vector<double>& nonlinear_parameters,
                           const std::vector<std::vector<double>>& candidates) {
  std::vector<double> best = nonlinear_parameters;
  double most = search.Drop(nonlinear_parameters);
  for (const std::vector<double>& candidate : candidates) {
    const double drop = search.Drop(candidate);
    if (!(drop > most)) continue;
    most = drop;
    best = candidate;
  }
  return best;
}

// Where in the gap the load begins moves the first impact alone, which is too sharp to be found downhill.
std::vector<double> BestBegin(StartSearch& search, const std::vector<double>& nonlinear_parameters) {
  std::vector<std::vector<double>> candidates;
  for (int k = -kBegins; k <= kBegins; ++k) {
    candidates.push_back(nonlinear_parameters);
    candidates.back()[4] = static_cast<double>(k) / kBegins;
  }
  return BestOf(search, nonlinear_parameters, candidates);
}

// The best nearby. A gap that is crossed in the same time is wider with less friction: along that the ground
// is too ragged to be walked.
std::vector<double> Nearby(StartSearch& search, const std::vector<double>& nonlinear_parameters) {
  std::vector<std::vector<double>> candidates;
  for (const double friction : kFrictions) {
    for (int wider = -kWider; wider <= kWider; ++wider)
      candidates.push_back({nonlinear_parameters[0] + wider * kWiderStep, friction, nonlinear_parameters[2],
                            nonlinear_parameters[3], nonlinear_parameters[4]});
  }
  return BestBegin(search, BestOf(search, nonlinear_parameters, candidates));
}

// Polished once more from a new simplex: on ragged ground the first one shrinks before its time. From the
// best nearby as well.
std::vector<double> PolishedAgain(StartSearch& search, const std::vector<double>& nonlinear_parameters) {
  std::vector<double> polished = search.Polish(nonlinear_parameters, kFineSteps);
  const std::vector<double> nearby = Nearby(search, polished);
  if (nearby == polished) return polished;
  return BestBegin(search, BestOf(search, polished, {search.Polish(nearby, kFineSteps)}));
}

// How far the load's push goes astray, row by row, if the gap and what happens in it are a little different:
// each impact comes at another time, and what comes after an impact depends on when and how hard that was.
Eigen::VectorXd SpreadOfImpacts(
    const std::function<void(std::span<const double>, Eigen::Ref<Eigen::MatrixXd>)>& fill,
    const std::vector<double>& nonlinear_parameters, Index rows) {
  Eigen::MatrixXd own(rows, 1);
  fill(nonlinear_parameters, own);
  Eigen::MatrixXd other(rows, 1);
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(rows);
  double count = 0.0;
  const auto add = [&](double wider, double friction, double start) {
    fill(std::vector{nonlinear_parameters[0] + wider, friction, nonlinear_parameters[2],
                     nonlinear_parameters[3], start},
         other);
    squares += (other - own).array().square();
    count += 1.0;
  };
  for (const double wider : kAstray) {
    for (const double friction :
         {0.7 * nonlinear_parameters[1], nonlinear_parameters[1], 1.4 * nonlinear_parameters[1] + 0.1})
      add(wider, friction, nonlinear_parameters[4]);
  }
  for (const double start : {-1.0, 0.0, 1.0}) add(0.0, nonlinear_parameters[1], start);
  return (squares / count).sqrt().matrix();
}

// What a search was for. A set of causes leaves the same but for rounding, whichever of them came last.
struct Left {
  std::vector<double> weighted{};
  double same{};  // difference that is none
  bool operator==(const Left& other) const {
    return std::ranges::equal(weighted, other.weighted,
                              [&](double a, double b) { return std::abs(a - b) < same; });
  }
};

}  // namespace

std::vector<double> InertiaBehindBacklashAtPoints(const MotionGrid& grid,
                                                  std::span<const double> nonlinear_parameters) {
  const model::InertiaBehindBacklash::Numbers numbers = NumbersOf(grid, nonlinear_parameters);
  std::vector<double> points(grid.time_s.size());
  FillInertiaBehindBacklash(grid, numbers, points);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] -= grid.passed_acceleration[i] + numbers.friction * grid.direction[i];
  return points;
}

void AddBacklash(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  const auto [first, last] = std::minmax_element(grid->position.begin(), grid->position.end());
  const double low = std::max(6.0 * grid->position_noise, 5e-5 * (*last - *first));
  const double high = 0.1 * (*last - *first);
  const double braking = BrakingOf(*grid);
  const double acceleration = QuantileOfMagnitude(grid->passed_acceleration, 0.68);
  // A contact oscillates faster than the motion, else it is a resonance, and slower than the points tell.
  const double low_Hz = 4.0;
  const double high_Hz = kFastestContact / grid->segments.front().step_s;
  if (!(high > 4.0 * low) || !(high_Hz > 2.0 * low_Hz)) return;
  SeparableTerm term;
  const Eigen::ArrayXd accelerates = WhereItAccelerates(*grid);
  term.fill = [grid, accelerates](std::span<const double> nonlinear_parameters,
                                  Eigen::Ref<Eigen::MatrixXd> design) {
    const model::InertiaBehindBacklash::Numbers numbers = NumbersOf(*grid, nonlinear_parameters);
    std::vector<double> points(grid->time_s.size());
    FillInertiaBehindBacklash(*grid, numbers, points);
    // Less what the nominal model has for a load that is held tight.
    design.col(0) =
        (grid->Project(points) - grid->nominal.col(0) - numbers.friction * grid->nominal.col(2)).array() *
        accelerates;
  };
  // Wide steps: each impact comes and goes at once, and a slope over less than that says nothing.
  term.nonlinear_parameters = {{std::log(low), std::log(high), kRagged},
                               {0.0, 4.0, kRagged},
                               {std::log(low_Hz), std::log(high_Hz), kRagged},
                               {0.1, 1.5, kRagged},
                               // Where in the gap the load happens to be is no property of the axis.
                               {-1.0, 1.0, kRagged, true}};
  std::vector<std::vector<double>> tried;
  for (const double gap : GeometricSteps(1.2 * low, 0.8 * high, 24)) {
    for (const double share : {0.0, 0.2, 0.6, 2.0}) {
      for (const double contact_Hz : {10.0, 18.0, 35.0, 80.0}) {
        if (contact_Hz < low_Hz || contact_Hz > high_Hz) continue;
        tried.push_back({std::log(gap), share, std::log(contact_Hz), 0.5, 0.0});
      }
    }
  }
  term.most_starts = kStarts;
  const auto map = std::make_shared<NonlinearParameterMap>(*grid, tried);
  const auto coarse_map = std::make_shared<NonlinearParameterMap>(*grid, std::move(tried), kImpact_s);
  FillMaps(term, grid->rows(), {map.get(), coarse_map.get()});
  const auto search_for = [grid, term, map, coarse_map](const WeightedResidual& residual) {
    using Start = std::pair<double, std::vector<double>>;  // drop, nonlinear parameters
    std::vector<Start> found;
    StartSearch search(*grid, term, residual, StartSearch::Sign::kPositive);
    StartSearch coarse_search(*grid, term, residual, StartSearch::Sign::kPositive, kImpact_s);
    for (const std::vector<double>& nonlinear_parameters : Apart(*map, residual)) {
      std::vector<double> polished = search.Polish(nonlinear_parameters, kFirstSteps);
      found.emplace_back(search.Drop(polished), std::move(polished));
    }
    for (const std::vector<double>& nonlinear_parameters : Apart(*coarse_map, residual)) {
      std::vector<double> polished =
          search.Polish(coarse_search.Polish(nonlinear_parameters, kFirstSteps), kFineSteps);
      found.emplace_back(search.Drop(polished), std::move(polished));
    }
    std::ranges::sort(found, std::greater<>(), &Start::first);
    std::vector<std::vector<double>> starts;
    for (auto& [drop, nonlinear_parameters] : found)
      starts.push_back(starts.size() < kStarts ? PolishedAgain(search, nonlinear_parameters)
                                               : std::move(nonlinear_parameters));
    return starts;
  };
  using Searched = Recent<Left, std::vector<std::vector<double>>>;
  term.starts = [search_for,
                 recent = std::make_shared<Searched>(kRecentSearches)](const WeightedResidual& residual) {
    Left left{.same = kSame * std::sqrt(residual.MeanSquare())};
    for (std::size_t i = 0; i < residual.values.size(); ++i)
      left.weighted.push_back(std::sqrt(residual.weights[i]) * residual.values[i]);
    return recent->Get(left, [&] { return search_for(residual); });
  };
  term.model_uncertainty =
      [fill = term.fill, rows = static_cast<Index>(grid->rows()),
       recent = std::make_shared<Recent<std::vector<double>, Eigen::VectorXd>>(kRecentModelUncertainties)](
          std::span<const double> numbers) -> Eigen::VectorXd {
    const std::vector<double> nonlinear_parameters(numbers.begin() + 1, numbers.end());
    return std::abs(numbers[0]) * recent->Get(nonlinear_parameters, [&] {
      return SpreadOfImpacts(fill, nonlinear_parameters, rows);
    });
  };
  const std::string gap_name = units.linear ? "backlash_m" : "backlash_rad";
  const std::string inertia_name = units.linear ? "load_mass_kg" : "load_inertia_kgm2";
  const std::string friction_name = "load_friction_" + units.torque();
  term.describe = [=](std::span<const double> numbers, const Eigen::MatrixXd& covariance) {
    const auto error = [&](Index k) { return StandardErrorOf(covariance(k, k)); };
    const double gap = std::exp(numbers[1]);
    const double deceleration = numbers[2] * braking;
    const double contact_Hz = std::exp(numbers[3]);
    // The edge of the gap is no sharper than the contact gives way.
    const double deflection = acceleration / std::pow(kTwoPi * contact_Hz, 2);
    return std::vector<ParameterValue>{
        {gap_name, units.position(), gap, std::hypot(gap * error(1), kContactEdge * deflection)},
        {inertia_name, units.inertia(), numbers[0], error(0)},
        {friction_name, units.torque(), numbers[0] * deceleration,
         std::hypot(error(0) * deceleration, numbers[0] * braking * error(2))},
        {"contact_Hz", "Hz", contact_Hz, contact_Hz * error(3)},
        {"contact_damping_ratio", "1", numbers[4], error(4)},
        {"load_start", "1", numbers[5], error(5)}};
  };
  term.restore = [=](std::span<const double> values) {
    return std::vector<double>{values[1],
                               std::log(std::max(values[0], 1e-300)),
                               values[2] / std::max(values[1] * braking, 1e-300),
                               std::log(values[3]),
                               values[4],
                               values[5]};
  };
  model.causes.push_back(std::move(term));
  model.rules.push_back(
      {.name = "backlash",
       .what_to_do = "look for play in coupling, key and nut, and record again",
       .sentence = "the load comes loose where the motion turns or slows down, and knocks where a gap is "
                   "crossed: play in a coupling, key, nut or the teeth",
       .where = Where::kUndecided,
       .effect = "E4",
       .parameters = {{gap_name, units.position(), 1.05 * low, 0.95 * high, true},
                      // How heavy the load is, and how it impacts, stand for each other: whether there is one
                      // the likelihood says.
                      {inertia_name, units.inertia(), 0.0, kUnlimited}},
       .degrees_of_freedom = 6,
       .known_by_size = true,
       .trials_factor = kSearchLocations,
       .misfit_share = kContactMisfit,
       .to_settle =
           units.linear
               ? ""
               : "# input locked, load to and fro: play of the gear shows as a "
                 "dead zone, that of the drive's coupling does not\n"
                 "- {kind: hysteresis, peak_torque: 34 Nm, torque_rate: 3 Nm/s, hold: 0.5 s, loops: 1}\n"});
}

}  // namespace strainwave::analysis::diagnosis
