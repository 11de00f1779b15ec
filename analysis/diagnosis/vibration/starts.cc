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

VibrationTerm TermOf(const VibrationResidual& residual, std::size_t index, VibrationForm form) {
  VibrationTerm term;
  term.cause = index;
  term.form = form;
  term.observable.assign(residual.samples().channels(), 1);
  return term;
}

Best SearchLine(const VibrationResidual& residual, std::size_t index, bool over_time) {
  const VibrationSpectrum& spectrum = over_time ? residual.over_seconds() : residual.over_turns();
  LeastLikelyChance best(residual);
  for (const SpectrumPeak& peak : FindPeaks(spectrum, 0.6 * spectrum.cell(), spectrum.highest(), 2)) {
    VibrationTerm term = TermOf(residual, index, over_time ? VibrationForm::kTones : VibrationForm::kLines);
    term.lines = {{1.0, 0.0}};
    term.nonlinear_parameters = {peak.order};
    best.TakeWithAndWithoutUnobservable(residual.WithAllChannels(std::move(term), 6), 0.0);
  }
  return std::move(best).fit();
}

Best SearchGrowth(const VibrationResidual& residual, std::size_t index) {
  const auto spread = [](const VibrationRun& run) { return run.speed_spread > kLeastSpeedSpread; };
  if (!std::ranges::any_of(residual.samples().runs, spread)) return std::nullopt;
  return residual.With(TermOf(residual, index, VibrationForm::kGrowth), 0);
}

}  // namespace

VibrationResidual::VibrationResidual(const VibrationSamples& samples, const VibrationSolver& solver,
                                     const VibrationSolution& base)
    : samples_(samples), solver_(solver), base_(base) {
  const Eigen::VectorXd left = solver.Residual(base);
  residual_.assign(left.data(), left.data() + left.size());
}

const SideBySide& VibrationResidual::side_by_side(std::size_t run) const {
  const std::vector<SideBySide>& all = side_by_side_.Get([&] {
    std::vector<SideBySide> made;
    for (const VibrationRun& own : samples_.runs) made.emplace_back(own, residual_, solver_.weights());
    return made;
  });
  return all[run];
}

const VibrationSpectrum& VibrationResidual::over_turns() const {
  return turns_.Get(
      [&] { return VibrationSpectrum(samples_, residual_, solver_.weights(), SpectrumAxis::kTurns); });
}

const VibrationSpectrum& VibrationResidual::over_seconds() const {
  return seconds_.Get(
      [&] { return VibrationSpectrum(samples_, residual_, solver_.weights(), SpectrumAxis::kSeconds); });
}

NoiseFit VibrationResidual::NoiseOf(std::vector<double> residual) const {
  Decorrelate(samples_, solver_.weights(), residual);
  return FitNoise(residual, solver_.weights(), samples_.segments, 1, std::sqrt(base_.variance()),
                  samples_.channel_starts);
}

const NoiseFit& VibrationResidual::noise() const {
  return noise_.Get([&] { return NoiseOf(residual_); });
}

double VibrationResidual::RatioOf(const TermFit& fit) const {
  const Eigen::VectorXd left = ResidualOf(fit);
  return LikelihoodRatio(NoiseOf({left.begin(), left.end()}), noise());
}

double VibrationResidual::RelativeNoiseAt(double frequency_Hz) const {
  if (noise().order == 0) return 1.0;
  const double turned = std::cos(kTwoPi * frequency_Hz * samples_.runs.front().period_s);
  double density = 0.0;
  double variance = 0.0;
  for (const Autoregression& series : noise().series) {
    const double lag_one = series.coefficients.empty() ? 0.0 : series.coefficients.front();
    const double innovations =
        static_cast<double>(series.samples) * series.innovation_sd * series.innovation_sd;
    density += innovations / (1.0 + lag_one * lag_one - 2.0 * lag_one * turned);
    variance += innovations / (1.0 - lag_one * lag_one);
  }
  return density / variance;
}

const OneTermSolver& VibrationResidual::one_term() const {
  return one_term_.Get([&] { return OneTermSolver(samples_, solver_, base_); });
}

TermFit VibrationResidual::WithAllChannels(VibrationTerm term, int rounds) const {
  TermFit fit = one_term().Fit(std::move(term));
  return rounds > 0 ? Refine(std::move(fit), rounds) : fit;
}

TermFit VibrationResidual::WithoutUnobservable(TermFit fit) const {
  one_term().Prune(fit);
  return fit;
}

TermFit VibrationResidual::With(VibrationTerm term, int rounds) const {
  return WithoutUnobservable(WithAllChannels(std::move(term), rounds));
}

void Keep(TermFit fit, std::optional<TermFit>& best) {
  if (!best || fit.bic() < best->bic()) best = std::move(fit);
}

double FoldedVibrationOrder(const VibrationSamples& samples, double order) {
  const double rate = 2.0 * samples.highest_order();
  return std::abs(order - rate * std::round(order / rate));
}

std::optional<TermFit> SearchCause(const VibrationResidual& residual, VibrationCause cause,
                                   std::size_t index) {
  const bool angle_known = residual.samples().angle_known();
  switch (cause) {
    case VibrationCause::kGearMesh:
      return angle_known ? SearchGearMesh(residual, index) : std::nullopt;
    case VibrationCause::kToothEngagement:
      return angle_known ? SearchToothEngagement(residual, index) : std::nullopt;
    case VibrationCause::kBearingDefect:
      return angle_known ? SearchBearing(residual, index) : std::nullopt;
    case VibrationCause::kFlexsplineCrack:
      return angle_known ? SearchCrack(residual, index) : std::nullopt;
    case VibrationCause::kImbalance:
      return angle_known ? SearchGrowth(residual, index) : std::nullopt;
    case VibrationCause::kTorsionalResonance:
      return SearchResonance(
          residual, index, {kLowestTorsional_Hz, kHighestTorsional_Hz, kLeastTorsionalDamping, angle_known});
    case VibrationCause::kHighResonance:
      return SearchResonance(
          residual, index,
          {kHighestTorsional_Hz, residual.samples().highest_Hz(), kLeastStructureDamping, false});
    case VibrationCause::kLineOverAngle:
      return angle_known ? SearchLine(residual, index, false) : std::nullopt;
    case VibrationCause::kLineOverTime:
      return SearchLine(residual, index, true);
    case VibrationCause::kBurst:
      return SearchBurst(residual, index);
    case VibrationCause::kSlowChange:
      return residual.With(TermOf(residual, index, VibrationForm::kLevels), 0);
  }
  return std::nullopt;
}

}  // namespace strainwave::analysis::diagnosis
