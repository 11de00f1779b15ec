// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/starts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/vibration/bursts.h"
#include "analysis/diagnosis/vibration/families.h"
#include "analysis/diagnosis/vibration/resonances.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Best = std::optional<VibrationSolution>;

VibrationTerm TermOf(const VibrationRemainder& remainder, std::size_t index, VibrationForm form) {
  VibrationTerm term;
  term.cause = index;
  term.form = form;
  term.heard.assign(remainder.samples().channels(), 1);
  return term;
}

Best SearchLine(const VibrationRemainder& remainder, std::size_t index, bool over_time) {
  const VibrationSpectrum& spectrum = over_time ? remainder.over_seconds() : remainder.over_turns();
  Best best;
  for (const SpectrumPeak& peak : FindPeaks(spectrum, 0.6 * spectrum.cell(), spectrum.highest(), 2)) {
    VibrationTerm term = TermOf(remainder, index, over_time ? VibrationForm::kTones : VibrationForm::kLines);
    term.lines = {{1.0, 0.0}};
    term.shapes = {peak.order};
    Keep(remainder.With(std::move(term), 6), best);
  }
  return best;
}

Best SearchGrowth(const VibrationRemainder& remainder, std::size_t index) {
  const auto spread = [](const VibrationRun& run) { return run.speed_spread > kLeastSpeedSpread; };
  if (!std::ranges::any_of(remainder.samples().runs, spread)) return std::nullopt;
  return remainder.With(TermOf(remainder, index, VibrationForm::kGrowth), 0);
}

}  // namespace

VibrationRemainder::VibrationRemainder(const VibrationSamples& samples, const VibrationSolver& solver,
                                       const VibrationSolution& base)
    : samples_(samples), solver_(solver), base_(base) {
  const Eigen::VectorXd left = solver.Residual(base);
  residual_.assign(left.data(), left.data() + left.size());
}

const VibrationSpectrum& VibrationRemainder::over_turns() const {
  if (!turns_) turns_.emplace(samples_, residual_, solver_.weights(), SpectrumAxis::kTurns);
  return *turns_;
}

const VibrationSpectrum& VibrationRemainder::over_seconds() const {
  if (!seconds_) seconds_.emplace(samples_, residual_, solver_.weights(), SpectrumAxis::kSeconds);
  return *seconds_;
}

VibrationSolution VibrationRemainder::With(VibrationTerm term, int rounds) const {
  std::vector<VibrationTerm> terms = base_.terms;
  terms.push_back(std::move(term));
  VibrationSolution solution = solver_.Solve(std::move(terms), &base_);
  if (rounds > 0) solution = Refine(std::move(solution), rounds);
  return solver_.Prune(std::move(solution));
}

VibrationSolution VibrationRemainder::Refine(VibrationSolution solution, int rounds) const {
  return solver_.Refine(std::move(solution), rounds, base_.terms.size());
}

void Keep(VibrationSolution solution, std::optional<VibrationSolution>& best) {
  if (!best || solution.bic() < best->bic()) best = std::move(solution);
}

double FoldedVibrationOrder(const VibrationSamples& samples, double order) {
  const double rate = 2.0 * samples.highest_order();
  return std::abs(order - rate * std::round(order / rate));
}

std::optional<VibrationSolution> SearchCause(const VibrationRemainder& remainder, VibrationCause cause,
                                             std::size_t index) {
  const bool angle_known = remainder.samples().angle_known();
  switch (cause) {
    case VibrationCause::kGearMesh:
      return angle_known ? SearchGearMesh(remainder, index) : std::nullopt;
    case VibrationCause::kBearingDefect:
      return angle_known ? SearchBearing(remainder, index) : std::nullopt;
    case VibrationCause::kFlexsplineCrack:
      return angle_known ? SearchCrack(remainder, index) : std::nullopt;
    case VibrationCause::kImbalance:
      return angle_known ? SearchGrowth(remainder, index) : std::nullopt;
    case VibrationCause::kTorsionalResonance:
      return SearchResonance(remainder, index, kLowestTorsional_Hz, kHighestTorsional_Hz, angle_known);
    case VibrationCause::kHighResonance:
      return SearchResonance(remainder, index, kHighestTorsional_Hz, remainder.samples().highest_Hz(), false);
    case VibrationCause::kLineOverAngle:
      return angle_known ? SearchLine(remainder, index, false) : std::nullopt;
    case VibrationCause::kLineOverTime:
      return SearchLine(remainder, index, true);
    case VibrationCause::kBurst:
      return SearchBurst(remainder, index);
    case VibrationCause::kSlowChange:
      return remainder.With(TermOf(remainder, index, VibrationForm::kLevels), 0);
  }
  return std::nullopt;
}

}  // namespace strainwave::analysis::diagnosis
