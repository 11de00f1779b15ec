// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <string>
#include <vector>

#include "analysis/diagnosis/vibration/impulse_train.h"
#include "analysis/diagnosis/vibration/samples.h"

namespace strainwave::analysis::diagnosis {

/// What a vibration term is made of. Columns come in pairs (a cosine and a sine part), except for
/// `kImpulseTrain`, `kPulses`, `kTransients` and `kLevels`: a mode moves all points of a housing in step, or
/// against each other.
enum class VibrationForm {
  kLines,         // lines at orders of the input angle; nonlinear parameters: a base order, or none
  kTones,         // lines at frequencies; nonlinear parameters: Hz
  kImpulseTrain,  // impulses at even angles that excite a resonance; nonlinear parameters: order, Hz,
                  // damping, two a modulation, phase a run
  kPulses,  // smooth pulses at even angles; nonlinear parameters: width or none, two a modulation, phase a
            // run
  kGrowth,  // 1 per turn, growing with the square of the speed; no nonlinear parameters
  kDriven,  // lines of the shaft across a resonance; nonlinear parameters: Hz, damping
  kNarrowband,  // a resonance driven by noise, no columns; nonlinear parameters: Hz, damping, size a channel
                // in noise
  kTransients,  // a resonance that rings after impacts; nonlinear parameters: Hz, damping, s; then s, height
  kBurst,       // a tone for a short while; nonlinear parameters: Hz, centre s, width s
  kLevels,      // slow change of the mean: powers of time 1 to 3; no nonlinear parameters
};

/// Order of a line: harmonic · base + offset, in lines per input turn (or Hz). A line that passes resonances
/// of the structure as the speed changes has further pairs of columns, in which it is multiplied by Legendre
/// polynomials of the speed (−1 at the slowest of all runs, 1 at the fastest).
struct LineOrder {
  double harmonic{};
  double offset{};
  int speed_power{};  // degree of the polynomial
  bool operator==(const LineOrder&) const = default;
};

/// Exponent by which a response's envelope falls from one impulse to the next, at least: what rings on
/// through several is a line.
inline constexpr double kLeastDecay = 0.3;

/// A term with its curved numbers; its coefficients are the solver's.
struct VibrationTerm {
  std::size_t cause{};
  VibrationForm form{VibrationForm::kLines};
  /// kDriven: `harmonic` alone; kImpulseTrain: order of a modulation in `offset`; kPulses: the order, then
  /// that of a modulation, in `offset`, with the width in the first one's `harmonic` where that is no shape.
  std::vector<LineOrder> lines;
  std::vector<double> nonlinear_parameters;
  std::vector<char> observable;  // one a channel of all runs: 0 where the term is left out
  std::vector<double>
      slips{};  // kImpulseTrain: of its impulses, as ImpulseTrain has them; found by a search, not fitted
};

/// Width of the pulses of a term: few records tell it, and a number that is not fitted costs nothing.
inline bool WidthIsNonlinearParameter(const VibrationTerm& pulses) { return pulses.lines[0].harmonic == 0.0; }

/// Bounds of a term's nonlinear parameters, and what a change has to be to matter.
struct VibrationNonlinearParameter {
  double low{};
  double high{};
  double step{};
};
std::vector<VibrationNonlinearParameter> NonlinearParametersOf(const VibrationSamples& samples,
                                                               const VibrationTerm& term);

Eigen::Index ColumnsOf(const VibrationTerm& term);

/// False for a term that filters what is there.
inline bool HasColumns(VibrationForm form) { return form != VibrationForm::kNarrowband; }

/// True where columns come as cosine and sine part.
bool HasPairs(VibrationForm form);

/// Columns of the term in one run.
Eigen::MatrixXd FillTerm(const VibrationSamples& samples, std::size_t run, const VibrationTerm& term);

/// Slopes of the term's columns, all of them by the first of its nonlinear parameters, then by the next.
/// @param columns  FillTerm
Eigen::MatrixXd FillSlopes(const VibrationSamples& samples, std::size_t run, const VibrationTerm& term,
                           const Eigen::Ref<const Eigen::MatrixXd>& columns);

/// The train of a term of form `kImpulseTrain` in one run.
ImpulseTrain TrainOf(const VibrationTerm& term, std::size_t run);

/// A fit's terms as numbers, and back.
std::vector<double> PackTerms(const std::vector<VibrationTerm>& terms);
std::vector<VibrationTerm> UnpackTerms(const std::vector<double>& state);

}  // namespace strainwave::analysis::diagnosis
