// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "analysis/diagnosis/noise_likelihood.h"
#include "analysis/diagnosis/on_first_use.h"
#include "analysis/diagnosis/vibration/impulse_train_match.h"
#include "analysis/diagnosis/vibration/one_term.h"
#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/solver.h"
#include "analysis/diagnosis/vibration/spectrum.h"
#include "analysis/diagnosis/vibration/terms.h"
#include "analysis/parallel_for.h"

namespace strainwave::analysis::diagnosis {

/// Kinds of cause and nuisance term, each with its own search.
enum class VibrationCause {
  kGearMesh,
  kToothEngagement,
  kBearingDefect,
  kImbalance,
  kTorsionalResonance,
  kFlexsplineCrack,
  kLineOverAngle,
  kLineOverTime,
  kHighResonance,
  kBurst,
  kSlowChange,
};

/// Limits of what is searched.
inline constexpr double kLowestBearingOrder =
    2.3;  // below are what shafts and a crack make, and no bearing's
inline constexpr double kHighestBearingOrder = 20.0;
inline constexpr double kLowestTorsional_Hz = 3.0;
inline constexpr double kHighestTorsional_Hz = 1000.0;  // above, a structure's
/// Less is a line of the shaft's at constant speed: grease and teeth damp a gear more, by some times this,
/// but a short record of what swings looks less damped than it is.
inline constexpr double kLeastTorsionalDamping = 1e-3;
inline constexpr double kLeastStructureDamping = 6e-4;
inline constexpr double kLeastSpeedSpread =
    0.08;  // of the mean speed, to tell growth with speed from a level

/// What a model leaves, for searches, several at once; all of it is made when first asked for.
class VibrationResidual {
 public:
  VibrationResidual(const VibrationSamples& samples, const VibrationSolver& solver,
                    const VibrationSolution& base);

  const ParallelFor& parallel() const { return solver_.parallel(); }
  const VibrationSamples& samples() const { return samples_; }
  const VibrationSolver& solver() const { return solver_; }
  const VibrationSolution& base() const { return base_; }
  std::span<const double> residual() const { return residual_; }
  /// The residual of one run for filters.
  const SideBySide& side_by_side(std::size_t run) const;
  const VibrationSpectrum& over_turns() const;
  const VibrationSpectrum& over_seconds() const;

  /// Noise of the model's residual, as candidates are compared: white, or first-order autoregressive.
  const NoiseFit& noise() const;

  /// Likelihood ratio of the model with a term under this noise.
  double RatioOf(const TermFit& fit) const;

  /// Noise about a frequency beside white noise of the same variance.
  double RelativeNoiseAt(double frequency_Hz) const;

  /// One more term, refined; channels in which it is not observable are left out.
  TermFit With(VibrationTerm term, int rounds) const;

  /// The same in all channels that the term says.
  TermFit WithAllChannels(VibrationTerm term, int rounds) const;

  /// The fit without channels in which its term is not observable.
  TermFit WithoutUnobservable(TermFit fit) const;

  TermFit Refine(TermFit fit, int rounds) const { return one_term().Refine(std::move(fit), rounds); }

  /// What base and term leave.
  Eigen::VectorXd ResidualOf(const TermFit& fit) const { return one_term().Residual(fit); }

 private:
  const VibrationSamples& samples_;
  const VibrationSolver& solver_;
  const VibrationSolution& base_;
  std::vector<double> residual_;
  const OneTermSolver& one_term() const;
  NoiseFit NoiseOf(std::vector<double> residual) const;

  OnFirstUse<std::vector<SideBySide>> side_by_side_;  // by run
  OnFirstUse<OneTermSolver> one_term_;
  OnFirstUse<VibrationSpectrum> turns_;
  OnFirstUse<VibrationSpectrum> seconds_;
  OnFirstUse<NoiseFit> noise_;
};

/// The best form of a cause beside a model; nothing where it has no support of its own (a bearing that would
/// be one line, a resonance that would be a tone).
std::optional<TermFit> SearchCause(const VibrationResidual& residual, VibrationCause cause,
                                   std::size_t index);

/// Order as it appears at this sampling rate.
double FoldedVibrationOrder(const VibrationSamples& samples, double order);

}  // namespace strainwave::analysis::diagnosis
