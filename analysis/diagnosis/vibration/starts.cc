// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/starts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/vibration/bursts.h"
#include "analysis/diagnosis/vibration/chance.h"
#include "analysis/diagnosis/vibration/families.h"
#include "analysis/diagnosis/vibration/gear_mesh.h"
#include "analysis/diagnosis/vibration/resonances.h"
#include "analysis/diagnosis/vibration/shared_noise.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Best = std::optional<TermFit>;

VibrationTerm TermOf(const VibrationRemainder& remainder, std::size_t index, VibrationForm form) {
  VibrationTerm term;
  term.cause = index;
  term.form = form;
  term.heard.assign(remainder.samples().channels(), 1);
  return term;
}

Best SearchLine(const VibrationRemainder& remainder, std::size_t index, bool over_time) {
  const VibrationSpectrum& spectrum = over_time ? remainder.over_seconds() : remainder.over_turns();
  LeastLikelyChance best(remainder);
  for (const SpectrumPeak& peak : FindPeaks(spectrum, 0.6 * spectrum.cell(), spectrum.highest(), 2)) {
    VibrationTerm term = TermOf(remainder, index, over_time ? VibrationForm::kTones : VibrationForm::kLines);
    term.lines = {{1.0, 0.0}};
    term.shapes = {peak.order};
    best.TakeWithAndWithoutDeaf(remainder.WithAllChannels(std::move(term), 6), 0.0);
  }
  return std::move(best).fit();
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

const SideBySide& VibrationRemainder::side_by_side(std::size_t run) const {
  if (side_by_side_.empty()) {
    for (const VibrationRun& own : samples_.runs)
      side_by_side_.emplace_back(own, residual_, solver_.weights());
  }
  return side_by_side_[run];
}

const VibrationSpectrum& VibrationRemainder::over_turns() const {
  if (!turns_) turns_.emplace(samples_, residual_, solver_.weights(), SpectrumAxis::kTurns);
  return *turns_;
}

const VibrationSpectrum& VibrationRemainder::over_seconds() const {
  if (!seconds_) seconds_.emplace(samples_, residual_, solver_.weights(), SpectrumAxis::kSeconds);
  return *seconds_;
}

NoiseFit VibrationRemainder::NoiseOf(std::vector<double> residual) const {
  Decorrelate(samples_, solver_.weights(), residual);
  return FitNoise(residual, solver_.weights(), samples_.stretches, 1, std::sqrt(base_.variance()));
}

const NoiseFit& VibrationRemainder::noise() const {
  if (!noise_) noise_ = NoiseOf(residual_);
  return *noise_;
}

double VibrationRemainder::RatioOf(const TermFit& fit) const {
  const Eigen::VectorXd left = ResidualOf(fit);
  return LikelihoodRatio(NoiseOf({left.begin(), left.end()}), noise());
}

double VibrationRemainder::LoudnessAt(double frequency_Hz) const {
  const double memory = noise().order > 0 ? noise().coefficients.front() : 0.0;
  const double turned = std::cos(kTwoPi * frequency_Hz * samples_.runs.front().period_s);
  return (1.0 - memory * memory) / (1.0 + memory * memory - 2.0 * memory * turned);
}

const OneTermSolver& VibrationRemainder::one_term() const {
  if (!one_term_) one_term_.emplace(samples_, solver_, base_);
  return *one_term_;
}

TermFit VibrationRemainder::WithAllChannels(VibrationTerm term, int rounds) const {
  TermFit fit = one_term().Fit(std::move(term));
  return rounds > 0 ? Refine(std::move(fit), rounds) : fit;
}

TermFit VibrationRemainder::WithoutDeaf(TermFit fit) const {
  one_term().Prune(fit);
  return fit;
}

TermFit VibrationRemainder::With(VibrationTerm term, int rounds) const {
  return WithoutDeaf(WithAllChannels(std::move(term), rounds));
}

void Keep(TermFit fit, std::optional<TermFit>& best) {
  if (!best || fit.bic() < best->bic()) best = std::move(fit);
}

double FoldedVibrationOrder(const VibrationSamples& samples, double order) {
  const double rate = 2.0 * samples.highest_order();
  return std::abs(order - rate * std::round(order / rate));
}

std::optional<TermFit> SearchCause(const VibrationRemainder& remainder, VibrationCause cause,
                                   std::size_t index) {
  const bool angle_known = remainder.samples().angle_known();
  switch (cause) {
    case VibrationCause::kGearMesh:
      return angle_known ? SearchGearMesh(remainder, index) : std::nullopt;
    case VibrationCause::kToothEngagement:
      return angle_known ? SearchToothEngagement(remainder, index) : std::nullopt;
    case VibrationCause::kBearingDefect:
      return angle_known ? SearchBearing(remainder, index) : std::nullopt;
    case VibrationCause::kFlexsplineCrack:
      return angle_known ? SearchCrack(remainder, index) : std::nullopt;
    case VibrationCause::kImbalance:
      return angle_known ? SearchGrowth(remainder, index) : std::nullopt;
    case VibrationCause::kTorsionalResonance:
      return SearchResonance(
          remainder, index, {kLowestTorsional_Hz, kHighestTorsional_Hz, kLeastTorsionalDamping, angle_known});
    case VibrationCause::kHighResonance:
      return SearchResonance(
          remainder, index,
          {kHighestTorsional_Hz, remainder.samples().highest_Hz(), kLeastStructureDamping, false});
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
