// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numeric>
#include <string_view>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/motion/backlash.h"
#include "analysis/diagnosis/motion/terms.h"
#include "analysis/diagnosis/recent.h"
#include "analysis/model/axis_motion.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kMisfitOfOscillation = 0.001;  // of squares; more than one inertia may oscillate

using Eigen::Index;

// Below that it is a tone in time and not a structure.
constexpr double kLeastDamping = 0.004;
constexpr double kMostShare = 1.5;  // of the inertia, that may oscillate
constexpr std::size_t kMostBeginnings = 4;
constexpr double kApart = 0.15;            // of ln frequency, that tells two starts apart
constexpr double kMostOscillation = 10.0;  // times the usual acceleration, where a segment begins
constexpr double kShortestShare = 0.02;    // of all points, that a segment with a beginning of its own has
constexpr double kDiedAway = 1e-20;        // of an oscillation's square
constexpr std::size_t kFirstFreeAmplitude = 2;  // of the nonlinear parameters
constexpr std::size_t kCachedOscillations = 8;
constexpr std::ptrdiff_t kFirstFreeValue = 5;

// Damping ratios of which a search starts, and their spacing in ln frequency.
constexpr std::array kDampings{std::pair{0.02, 0.03}, std::pair{0.07, 0.08}, std::pair{0.3, 0.25}};

double DurationOf(const MotionGrid& grid) {
  double duration_s = 0.0;
  for (const MotionGrid::Segment& segment : grid.segments) {
    duration_s += segment.step_s * static_cast<double>(segment.count);
  }
  return duration_s;
}

// Segments, in order, that may begin with an oscillation: what moved it before, or within a gap, nobody
// recorded.
std::vector<std::size_t> Beginnings(const MotionGrid& grid) {
  std::vector<std::size_t> longest(grid.segments.size());
  std::iota(longest.begin(), longest.end(), std::size_t{0});
  const auto count = [&](std::size_t s) { return grid.segments[s].count; };
  std::ranges::stable_sort(longest, std::greater<>(), count);
  if (longest.size() > kMostBeginnings) longest.resize(kMostBeginnings);
  const double fewest = kShortestShare * static_cast<double>(grid.time_s.size());
  while (longest.size() > 1 && static_cast<double>(count(longest.back())) < fewest) longest.pop_back();
  std::ranges::sort(longest);
  return longest;
}

std::string OfBeginning(std::string_view name, std::size_t number) {
  return number == 0 ? std::string(name) : fmt::format("{}_{}", name, number + 1);
}

// What oscillations of one frequency that begin with the segments, in whatever phase, take from the
// residual's weighted sum of squares, about.
double FreeOscillationDrop(const MotionGrid& grid, const WeightedResidual& residual,
                           std::span<const std::size_t> beginnings, double natural, double damping) {
  const std::complex<double> exponent = natural * std::complex<double>(-damping, 1.0);
  const std::complex<double> usual_turn = std::exp(exponent * grid.row_spacing_s);
  double drop = 0.0;
  for (const std::size_t segment : beginnings) {
    const auto [begin, end] =
        std::equal_range(grid.segment_of_row.begin(), grid.segment_of_row.end(), segment);
    double before_s = grid.time_s[grid.segments[segment].first];
    std::complex<double> oscillation = 1.0;
    std::complex<double> along = 0.0;
    double squares = 0.0;
    for (auto it = begin; it != end; ++it) {
      const auto row = static_cast<std::size_t>(it - grid.segment_of_row.begin());
      const double step_s = grid.RowTime_s(row) - before_s;
      before_s += step_s;
      oscillation *= std::abs(step_s - grid.row_spacing_s) < 1e-9 * grid.row_spacing_s
                         ? usual_turn
                         : std::exp(exponent * step_s);
      along += residual.weights[row] * residual.values[row] * oscillation;
      squares += residual.weights[row] * std::norm(oscillation);
    }
    if (squares > 0.0) drop += 2.0 * std::norm(along) / squares;
  }
  return drop;
}

// What oscillates as the motion drives it, at the points.
std::vector<double> DrivenOscillation(const MotionGrid& grid, double natural, double damping) {
  std::vector<double> points(grid.time_s.size());
  for (const MotionGrid::Segment& segment : grid.segments) {
    model::SecondInertia inertia(natural, damping, segment.step_s);
    for (std::size_t i = segment.first; i < segment.first + segment.count; ++i)
      points[i] = inertia.Step(grid.passed_acceleration[i]);
  }
  return points;
}

// What oscillates freely from a segment's beginning until it has died away, at the rows: in phase, and a
// quarter of a turn later.
Eigen::MatrixX2d FreeOscillation(const MotionGrid& grid, const MotionGrid::Segment& segment, double natural,
                                 double damping) {
  std::vector<double> in_phase(grid.time_s.size());
  std::vector<double> late(grid.time_s.size());
  // Turned on from point to point, which are at even steps.
  const double damped = natural * std::sqrt(1.0 - damping * damping);
  const std::complex<double> turn =
      std::polar(std::exp(-damping * natural * segment.step_s), damped * segment.step_s);
  std::complex<double> oscillation = 1.0;
  const std::size_t end = segment.first + segment.count;
  for (std::size_t i = segment.first; i < end && std::norm(oscillation) > kDiedAway; ++i) {
    in_phase[i] = oscillation.real();
    late[i] = oscillation.imag();
    oscillation *= turn;
  }
  Eigen::MatrixX2d columns(static_cast<Index>(grid.rows()), 2);
  columns << grid.ProjectPassed(in_phase), grid.ProjectPassed(late);
  return columns;
}

void AddResonance(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  const double low_Hz = std::max(4.0 / DurationOf(*grid), 1e-3);
  // An oscillation that an acceleration transient started may be faster than the motion.
  const double high_Hz =
      std::min(1.2 * grid->cutoff_rad_per_s(), 4.0 * grid->path_cutoff_rad_per_s()) / kTwoPi;
  if (!(high_Hz > 3.0 * low_Hz)) return;
  const std::vector<std::size_t> beginnings = Beginnings(*grid);
  const double usual = UsualSize(grid->passed_acceleration);
  SeparableTerm term;
  // Slopes by what a segment begins with are taken at one frequency and damping, in which it is straight.
  const auto driven_oscillations =
      std::make_shared<Recent<std::array<double, 2>, Eigen::VectorXd>>(kCachedOscillations);
  const auto free_oscillations = std::make_shared<Recent<std::array<double, 3>, Eigen::MatrixX2d>>(
      kCachedOscillations * beginnings.size());
  term.fill = [=](std::span<const double> nonlinear_parameters, Eigen::Ref<Eigen::MatrixXd> design) {
    const double natural = kTwoPi * std::exp(nonlinear_parameters[0]);
    const double damping = std::exp(nonlinear_parameters[1]);
    design.col(0) = driven_oscillations->Get({nonlinear_parameters[0], nonlinear_parameters[1]}, [&] {
      return grid->ProjectPassed(DrivenOscillation(*grid, natural, damping));
    });
    for (std::size_t b = 0; b < beginnings.size(); ++b) {
      const Eigen::Map<const Eigen::Vector2d> sizes(nonlinear_parameters.data() + kFirstFreeAmplitude +
                                                    2 * b);
      if (sizes.isZero(0.0)) continue;
      design.col(0) +=
          free_oscillations->Get(
              {static_cast<double>(b), nonlinear_parameters[0], nonlinear_parameters[1]},
              [&] { return FreeOscillation(*grid, grid->segments[beginnings[b]], natural, damping); }) *
          (usual * sizes);
    }
  };
  term.nonlinear_parameters = {{std::log(low_Hz), std::log(high_Hz), 0.03},
                               {std::log(kLeastDamping), std::log(0.8), 0.3, true}};
  // It may oscillate already where a segment begins: over the usual acceleration of the motion, in phase and
  // a quarter of a turn later.
  const std::size_t nonlinear_parameters = kFirstFreeAmplitude + 2 * beginnings.size();
  term.nonlinear_parameters.resize(nonlinear_parameters,
                                   {-kMostOscillation, kMostOscillation, 0.1, true, Moved::kWhereItPays});

  std::vector<std::vector<double>> tried;  // ln frequency in Hz, ln damping ratio
  for (const auto& [damping, spacing] : kDampings) {
    for (double log_Hz = std::log(low_Hz) + spacing; log_Hz < std::log(high_Hz); log_Hz += spacing) {
      tried.emplace_back(nonlinear_parameters, 0.0);
      tried.back()[0] = log_Hz;
      tried.back()[1] = std::log(damping);
    }
  }
  term.most_starts = kDampings.size();
  const double reference = std::max(grid->prefit(0), 1e-300);
  const auto map = std::make_shared<NonlinearParameterMap>(*grid, std::move(tried));
  FillMaps(term, grid->rows(), {map.get()});
  term.starts = [grid, beginnings, map, reference](const WeightedResidual& residual) {
    std::vector<std::vector<double>> starts;
    Eigen::VectorXf left = map->Roots(residual);
    // Far above the motion an oscillation of any inertia looks alike, up to what no axis carries.
    for (Index k = 0; k < left.size(); ++k) {
      if (map->Coefficient(k, static_cast<double>(left(k))) > kMostShare * reference) left(k) = 0.0F;
    }
    // One of each damping: a blunt one fits half of everything that oscillates, and would leave no other.
    for (Index best = 0; left.maxCoeff(&best) > 0.0F;) {
      starts.push_back(map->nonlinear_parameters()[static_cast<std::size_t>(best)]);
      for (Index k = 0; k < left.size(); ++k) {
        const std::vector<double>& other = map->nonlinear_parameters()[static_cast<std::size_t>(k)];
        if (other[1] == starts.back()[1] || std::abs(other[0] - starts.back()[0]) < kApart) left(k) = 0.0F;
      }
    }
    // What a segment begins with may be most of the oscillation, and in any phase to what the motion drives.
    if (starts.empty()) return starts;
    std::vector<double> free = starts.front();
    double most = 0.0;
    for (const std::vector<double>& sharp : map->nonlinear_parameters()) {
      if (sharp[1] != map->nonlinear_parameters().front()[1]) break;
      const double drop =
          FreeOscillationDrop(*grid, residual, beginnings, kTwoPi * std::exp(sharp[0]), std::exp(sharp[1]));
      if (drop > most) free = sharp;
      most = std::max(most, drop);
    }
    starts.push_back(std::move(free));
    return starts;
  };
  const std::string inertia = units.linear ? "second_mass_kg" : "second_inertia_kgm2";
  const std::string swinging = "swinging_" + inertia;
  const double usual_rad_per_s = usual / std::max(UsualSize(grid->velocity), 1e-300);
  term.describe = [=, count = beginnings.size()](std::span<const double> numbers,
                                                 const Eigen::MatrixXd& covariance) {
    const double frequency_Hz = std::exp(numbers[1]);
    const double damping = std::exp(numbers[2]);
    const double error = StandardErrorOf(covariance(0, 0));
    // How much oscillates is known even where inertia and frequency are not, or inertia and an oscillation
    // that the record begins with: J₂ √(w² + s²), w = (Ω / ω)² what a motion of frequency Ω drives below its
    // own.
    const double driven = std::pow(usual_rad_per_s / (kTwoPi * frequency_Hz), 2);
    const Eigen::Map<const Eigen::VectorXd> begun(numbers.data() + 1 + kFirstFreeAmplitude,
                                                  static_cast<Index>(2 * count));
    const double root = std::hypot(driven, begun.norm());
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(covariance.rows());
    slope(0) = root;
    slope(1) = -2.0 * numbers[0] * driven * driven / root;
    slope.tail(begun.size()) = numbers[0] / root * begun;
    std::vector<ParameterValue> values{
        {"frequency_Hz", "Hz", frequency_Hz, frequency_Hz * StandardErrorOf(covariance(1, 1))},
        {"damping_ratio", "1", damping, damping * StandardErrorOf(covariance(2, 2))},
        {"inertia_share", "1", numbers[0] / reference, error / reference},
        {inertia, units.inertia(), numbers[0], error},
        {swinging, units.inertia(), numbers[0] * root, StandardErrorOf(slope.dot(covariance * slope))}};
    for (std::size_t b = 0; b < count; ++b) {
      const std::size_t at = 1 + kFirstFreeAmplitude + 2 * b;
      const auto error_of = [&](std::size_t k) {
        return StandardErrorOf(covariance(static_cast<Index>(k), static_cast<Index>(k)));
      };
      values.push_back({OfBeginning("swing_at_start", b), "1", numbers[at], error_of(at), true});
      values.push_back({OfBeginning("swing_at_start_late", b), "1", numbers[at + 1], error_of(at + 1), true});
    }
    return values;
  };
  term.restore = [](std::span<const double> values) {
    std::vector<double> numbers{values[3], std::log(std::max(values[0], 1e-9)),
                                std::log(std::max(values[1], 1e-9))};
    numbers.insert(numbers.end(), values.begin() + kFirstFreeValue, values.end());
    return numbers;
  };
  model.causes.push_back(std::move(term));
  model.rules.push_back({.name = "torsional_resonance",
                         .what_to_do = "look for a loose coupling or shaft between drive and load, and keep "
                                       "the drive's set points below the frequency named",
                         .sentence = "a second inertia behind a compliance swings: a soft coupling, shaft, "
                                     "screw or gear between drive and load",
                         .where = Where::kUndecided,
                         .effect = "E15",
                         .parameters = {{"inertia_share", "1", 0.0, kMostShare, false},
                                        {swinging, units.inertia(), 0.0, kUnlimited, true},
                                        {"frequency_Hz", "Hz", 1.02 * low_Hz, 0.98 * high_Hz, false},
                                        {"damping_ratio", "1", 1.1 * kLeastDamping, 0.4, false}},
                         .degrees_of_freedom = 3,
                         .trials_factor = std::max(10.0, 10.0 * std::log(high_Hz / low_Hz)),
                         .misfit_share = kMisfitOfOscillation,
                         // What tells its frequency may be one short acceleration transient.
                         .local = true,
                         .to_settle = units.linear ? ""
                                                   : "# the same motion with another inertia on the output: "
                                                     "the frequency moves if the compliance is the unit's\n"
                                                     "- kind: load_run\n  name: other-inertia\n  duration: 1 "
                                                     "min\n  output_torque: 0 Nm\n  input_speed: 500 rpm\n"});
}

}  // namespace

void AddDynamicCauses(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  AddResonance(grid, units, model);
  AddBacklash(grid, units, model);
}

}  // namespace strainwave::analysis::diagnosis
