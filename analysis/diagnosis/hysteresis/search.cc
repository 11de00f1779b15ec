// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/hysteresis/inter_sample_extrema.h"
#include "analysis/prepared_loop.h"
#include "analysis/stiffness_start.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr std::size_t kSearchPoints = 1500;
constexpr int kFewIterations = 2;
constexpr int kFitted = 2;                    // of the ranked starts
constexpr double kAnotherLocalMinimum = 0.7;  // of ln yield twist

Eigen::VectorXd RootsOf(const std::vector<double>& weights) {
  return Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Index>(weights.size())).cwiseSqrt();
}

// Column space of what the fitted numbers can follow.
Eigen::MatrixXd OrthonormalColumns(const Eigen::MatrixXd& derivatives) {
  std::vector<Index> used;
  for (Index k = 0; k < derivatives.cols(); ++k) {
    if (derivatives.col(k).squaredNorm() > 0.0) used.push_back(k);
  }
  Eigen::MatrixXd columns = derivatives(Eigen::all, used);
  for (Index k = 0; k < columns.cols(); ++k) columns.col(k).normalize();
  return OrthonormalBasis(columns);
}

struct RankedStart {
  Eigen::VectorXd numbers;
  double promised{};  // likelihood ratio, to first order
  double merit{};     // that, less what the form costs
};

// Puts the amounts where they bring most, to first order, and says how much.
RankedStart RankStart(const LoopModel& model, std::size_t effect, const LoopGrid& grid, Eigen::VectorXd x,
                      const Eigen::MatrixXd& followed, const Eigen::VectorXd& residual,
                      const Eigen::VectorXd& roots, const Eigen::VectorXd& gear_rad) {
  RankedStart ranked{std::move(x)};
  Eigen::MatrixXd columns = roots.asDiagonal() * model.AmountColumns(ranked.numbers, grid, effect, gear_rad);
  columns -= followed * (followed.transpose() * columns).eval();
  const Eigen::MatrixXd normal = columns.transpose() * columns;
  const Eigen::VectorXd drive = columns.transpose() * residual;
  const double floor = 1e-12 * normal.diagonal().maxCoeff();
  Eigen::VectorXd sizes =
      SymmetricFactor(normal + floor * Eigen::MatrixXd::Identity(normal.rows(), normal.cols())).Solve(drive);
  const std::vector<int> amounts = model.Amounts(ranked.numbers, effect);
  for (std::size_t j = 0; j < amounts.size(); ++j) {
    const FitNumber& number = model.numbers()[static_cast<std::size_t>(amounts[j])];
    double& value = ranked.numbers[amounts[j]];
    const double before = value;
    const double size = sizes(static_cast<Index>(j));
    value = std::isfinite(size) ? std::clamp(before + size, number.low, number.high) : before;
    sizes(static_cast<Index>(j)) = value - before;
  }
  const double drop = 2.0 * sizes.dot(drive) - sizes.dot(normal * sizes);
  ranked.promised = static_cast<double>(grid.size()) * drop / std::max(residual.squaredNorm(), 1e-300);
  ranked.merit =
      ranked.promised - 2.0 * model.effects()[effect]->LogSearchLocations(model.Of(effect, ranked.numbers));
  return ranked;
}

// What a fitted model leaves on a grid, and what its numbers can follow.
class Surroundings {
 public:
  Surroundings(const LoopModel& model, const Eigen::VectorXd& x, const LoopGrid& grid)
      : roots_(RootsOf(grid.weight)), law_(model.LawOf(x)) {
    FillTwist(law_, grid, gear_rad_);
    Eigen::MatrixXd derivatives;
    const Eigen::VectorXd predicted = model.Predict(x, grid, derivatives);
    residual_ = Eigen::Map<const Eigen::VectorXd>(grid.twist_rad.data(), predicted.size()) - predicted;
    followed_ = OrthonormalColumns(roots_.asDiagonal() * derivatives);
  }

  LoopResidual Residual(const LoopRecords& records, const LoopGrid& grid) const {
    return {records, grid, law_, {residual_.data(), static_cast<std::size_t>(residual_.size())}};
  }

  // Proposed numbers of one effect, put into `base`, the most promising first.
  std::vector<RankedStart> Rank(const LoopModel& model, std::size_t effect, const LoopGrid& grid,
                                const std::vector<std::vector<double>>& proposals,
                                const Eigen::VectorXd& base) const {
    const Eigen::VectorXd weighted = roots_.cwiseProduct(residual_);
    std::vector<RankedStart> ranked;
    for (const std::vector<double>& proposal : proposals) {
      Eigen::VectorXd start = base;
      std::copy(proposal.begin(), proposal.end(), model.Of(effect, start).begin());
      ranked.push_back(
          RankStart(model, effect, grid, std::move(start), followed_, weighted, roots_, gear_rad_));
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const RankedStart& a, const RankedStart& b) { return a.merit > b.merit; });
    return ranked;
  }

 private:
  Eigen::VectorXd roots_;
  GearLaw law_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd followed_;
  Eigen::VectorXd gear_rad_;
};

// What promises next to nothing where its amounts are put first is not worth following to its end.
constexpr double kNextToNothing = 4.0;  // of the likelihood ratio

// Fits the most promising start of each form, up to a few of them.
void FitBest(const std::vector<RankedStart>& ranked, const LoopModel& model, std::size_t effect,
             const LoopGrid& grid, double worth_following, LoopSolution& best) {
  const bool has_forms = model.effects()[effect]->numbers.front().held;
  constexpr double kTheSame =
      1e-9;  // of what is promised: forms that differ in what this record does not have
  std::vector<double> forms;
  std::optional<double> last;
  int fits = 0;
  for (const RankedStart& start : ranked) {
    const double form = model.Of(effect, start.numbers)[0];
    if (has_forms) {
      if (std::ranges::find(forms, form) != forms.end()) continue;
      forms.push_back(form);
      if (last && std::abs(*last - start.promised) <= kTheSame * *last) continue;
      last = start.promised;
    }
    LoopSolution solution = SolveLoop(model, grid, start.numbers,
                                      start.promised < worth_following ? kFewIterations : kMostIterations);
    if (!std::isfinite(best.cost) ||
        PenalisedCost(model, grid, solution) < PenalisedCost(model, grid, best)) {
      best = std::move(solution);
    }
    if (++fits == kFitted) return;
  }
}

// The effect's starts beside the other numbers of `x`, the most promising first.
std::vector<RankedStart> RankStarts(const LoopRecords& records, const LoopModel& model, std::size_t effect,
                                    const LoopGrid& grid, const Eigen::VectorXd& x) {
  std::vector<const LoopEffect*> others = model.effects();
  const LoopEffect& added = *others[effect];
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(effect));
  const LoopModel poorer(records, others);
  // The numbers of the effect lie in one piece.
  Eigen::VectorXd without(poorer.size());
  const auto place = static_cast<Index>(model.Of(effect, x).data() - x.data());
  const auto count = static_cast<Index>(added.numbers.size());
  without << x.head(place), x.tail(x.size() - place - count);
  const Surroundings beside(poorer, without, grid);
  return beside.Rank(model, effect, grid, added.Starts(beside.Residual(records, grid)), x);
}

// The nominal numbers that the grid search of the stiffness fit proposes for one record.
std::vector<Eigen::VectorXd> ProposedStarts(const LoopRecords& records, std::size_t record) {
  const LoopGrid& grid = records.samples;
  const std::size_t first = grid.starts[record];
  const std::size_t count = grid.starts[record + 1] - first;
  const TorsionLoop raw{std::span(grid.time_s).subspan(first, count),
                        std::span(grid.torque_Nm).subspan(first, count),
                        std::span(grid.twist_rad).subspan(first, count)};
  const TestTorques torques{
      .t1_Nm = records.t1_Nm, .t2_Nm = records.t2_Nm, .t3_Nm = std::max(records.t3_Nm, 1.01 * records.t2_Nm)};
  const PreparedLoop loop = PrepareLoop(raw, torques);
  const ThinnedLoop thinned = ThinLoop(loop, MakeLoopInputs(loop));
  std::vector<Eigen::VectorXd> starts;
  for (const StiffnessParameters& p : StiffnessStarts(loop, thinned, records.twist_range_rad)) {
    Eigen::VectorXd x(kFirstOfRecord + kNumbersOfRecord);
    x << p[kLogK1], p[kLogK2], p[kLogK3], p[kLogFriction],
        std::log(ArcminFromRad(std::exp(p[kLogYieldTwist]))),
        ArcminFromRad(p[kTwistOffset] * records.twist_range_rad), p[kStartShare];
    starts.push_back(std::move(x));
  }
  return starts;
}

// A servo rounds its corners off, and a simulation knows no torque between its samples: turns between them
// stay only where the angle says that the gear went there.
// @returns the nominal numbers with the turns as they are kept.
Eigen::VectorXd SettleTurns(LoopRecords& records, const LoopModel& model, const Eigen::VectorXd& x) {
  LoopGrid& samples = records.samples;
  if (std::ranges::all_of(samples.turn_Nm, [](double turn_Nm) { return std::isnan(turn_Nm); })) return x;
  LoopGrid at_samples = samples;
  std::ranges::fill(at_samples.turn_Nm, std::numeric_limits<double>::quiet_NaN());
  const LoopSolution between = SolveLoop(model, samples, x, kMostIterations);
  const LoopSolution there = SolveLoop(model, at_samples, x, kMostIterations);
  if (!(there.cost < between.cost)) return between.numbers;
  samples = std::move(at_samples);
  return there.numbers;
}

// Peaks that no sample saw but whose effect on the friction remains.
// @returns the nominal numbers with them.
Eigen::VectorXd SettlePeaks(LoopRecords& records, const LoopModel& model, const Eigen::VectorXd& x) {
  constexpr int kRounds = 3;
  const std::vector<double> turns_Nm = records.samples.turn_Nm;
  Eigen::VectorXd numbers = x;
  for (int round = 0; round < kRounds; ++round) {
    LoopGrid samples = records.samples;
    samples.turn_Nm = turns_Nm;
    const Eigen::VectorXd predicted_rad = model.Predict(numbers, samples);
    if (!SetInterSampleExtrema(model.LawOf(numbers), predicted_rad, records.noise_floor_rad, samples)) break;
    numbers = SolveLoop(model, samples, numbers, kMostIterations).numbers;
    records.samples = std::move(samples);
  }
  return numbers;
}

}  // namespace

double PenalisedCost(const LoopModel& model, const LoopGrid& grid, const LoopSolution& solution) {
  const auto n = static_cast<double>(grid.size());
  return n * std::log(std::max(solution.cost, 1e-300)) +
         model.FreeParameters(solution.numbers) * std::log(n) +
         2.0 * model.LogSearchLocations(solution.numbers);
}

NominalLocalMinima FindNominal(LoopRecords& records) {
  const LoopModel model(records, {});
  const LoopGrid grid = Condense(records, records.samples.weight, kSearchPoints);
  std::vector<Eigen::VectorXd> starts;
  for (std::size_t r = 0; r < records.samples.records(); ++r) {
    const std::vector<Eigen::VectorXd> proposed = ProposedStarts(records, r);
    const int own = kFirstOfRecord + kNumbersOfRecord * static_cast<int>(r);
    for (std::size_t s = 0; s < proposed.size() && r == 0; ++s) {
      starts.push_back(Eigen::VectorXd::Zero(model.size()));
      starts.back().head(kFirstOfRecord) = proposed[s].head(kFirstOfRecord);
    }
    for (Eigen::VectorXd& start : starts) {
      start.segment(own, kNumbersOfRecord) = proposed[0].segment(kFirstOfRecord, kNumbersOfRecord);
    }
  }
  // The yield twist decides which local minimum a fit ends in.
  const Eigen::VectorXd first = starts.front();
  for (const double factor : {0.25, 4.0}) {
    starts.push_back(first);
    starts.back()[kLnYield] += std::log(factor);
  }
  std::vector<LoopSolution> local_minima;
  for (const Eigen::VectorXd& start : starts) {
    LoopSolution solution = SolveLoop(model, grid, start, kMostIterations);
    if (std::isfinite(solution.cost)) local_minima.push_back(std::move(solution));
  }
  std::ranges::stable_sort(local_minima, {}, &LoopSolution::cost);
  const Eigen::VectorXd& best = local_minima.empty() ? first : local_minima.front().numbers;
  const auto other = std::ranges::find_if(local_minima, [&](const LoopSolution& local_minimum) {
    return std::abs(local_minimum.numbers[kLnYield] - best[kLnYield]) > kAnotherLocalMinimum;
  });
  return {SettlePeaks(records, model, SettleTurns(records, model, best)),
          other == local_minima.end() ? Eigen::VectorXd() : other->numbers};
}

LoopSolution FitWithNewEffect(const LoopRecords& records, const LoopModel& model, std::size_t effect,
                              const LoopGrid& grid, const Eigen::VectorXd& x) {
  LoopSolution best{x, std::numeric_limits<double>::infinity()};
  FitBest(RankStarts(records, model, effect, grid, x), model, effect, grid, kNextToNothing, best);
  if (!std::isfinite(best.cost)) return best;

  const Surroundings with(model, best.numbers, grid);
  const auto forms =
      model.effects()[effect]->RicherForms(model.Of(effect, best.numbers), with.Residual(records, grid));
  if (!forms.empty()) {
    LoopSolution richer{best.numbers, std::numeric_limits<double>::infinity()};
    // A form that begins as what it comes from shows in none of its amounts what it will bring.
    FitBest(with.Rank(model, effect, grid, forms, best.numbers), model, effect, grid, 0.0, richer);
    constexpr double kClearly = 10.0;
    if (PenalisedCost(model, grid, richer) < PenalisedCost(model, grid, best) - kClearly)
      best = std::move(richer);
  }
  return best;
}

std::vector<Alternative> FitAlternatives(const LoopRecords& records, const LoopModel& model,
                                         std::size_t effect, const LoopGrid& grid, const Eigen::VectorXd& x) {
  constexpr double kOutOfQuestion = 20.0;  // of BIC: where the noise is coloured it counts for less
  constexpr int kSegments = 30;
  std::vector<Alternative> alternatives;
  const LoopEffect& own = *model.effects()[effect];
  if (!own.numbers.front().held) return alternatives;
  std::vector<LoopSolution> best{SolveLoop(model, grid, x, kMostIterations)};
  std::vector<double> seen{model.Of(effect, x)[0]};
  for (const RankedStart& start : RankStarts(records, model, effect, grid, x)) {
    const double form = model.Of(effect, start.numbers)[0];
    if (std::find(seen.begin(), seen.end(), form) != seen.end()) continue;
    seen.push_back(form);
    best.push_back(SolveLoop(model, grid, start.numbers, kMostIterations));
    alternatives.push_back({best.back().numbers});
  }
  if (own.NonlinearParameter() < 0) return alternatives;
  const auto nonlinear_parameter = static_cast<std::size_t>(own.NonlinearParameter());
  const FitNumber& range = own.numbers[nonlinear_parameter];
  const double segment = (range.high - range.low) / kSegments;
  const double least = PenalisedCost(model, grid, best[0]);
  for (const LoopSolution& form : best) {
    if (PenalisedCost(model, grid, form) > least + kOutOfQuestion ||
        own.IsHeld(model.Of(effect, form.numbers), nonlinear_parameter)) {
      continue;
    }
    LoopModel at = model;
    at.Hold(static_cast<int>(model.Of(effect, form.numbers).data() - form.numbers.data()) +
            own.NonlinearParameter());
    for (const double way : {-segment, segment}) {
      LoopSolution next = form;
      for (;;) {
        double& value = at.Of(effect, next.numbers)[nonlinear_parameter];
        if (value + way < range.low || value + way > range.high) break;
        value += way;
        next = SolveLoop(at, grid, next.numbers, kMostIterations);
        if (PenalisedCost(model, grid, next) > least + kOutOfQuestion) break;
        alternatives.push_back({next.numbers, segment});
      }
    }
  }
  return alternatives;
}

}  // namespace strainwave::analysis::diagnosis
