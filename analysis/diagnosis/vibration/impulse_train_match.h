// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/diagnosis/phasors.h"
#include "analysis/diagnosis/vibration/impulse_train.h"
#include "analysis/diagnosis/vibration/samples.h"

/// Where decaying responses, and trains of them, explain most of a residual.
namespace strainwave::analysis::diagnosis {

/// The largest whole number that is not above one: the library's is a call for every sample, where the
/// machine is not known.
inline std::int64_t WholeBelow(double value) {
  const auto whole = static_cast<std::int64_t>(value);
  return value < static_cast<double>(whole) ? whole - 1 : whole;
}

/// Directions after so many turns, to some thousandths of a radian: good enough to search.
class Directions {
 public:
  /// Made once, by the first who asks.
  static const Directions& Table();
  std::complex<double> After(double turns) const {
    return table_[static_cast<std::size_t>(WholeBelow(turns * kDirections)) % kDirections];
  }

 private:
  Directions();

  static constexpr std::size_t kDirections = 2048;
  std::vector<std::complex<double>> table_;
};

/// A residual of one run with its channels side by side, a few together: a filter is a chain of products that
/// wait for one another, and several run in the time of one. Samples without weight count as zero.
class SideBySide {
 public:
  static constexpr std::size_t kTogether = 4;

  SideBySide(const VibrationRun& run, std::span<const double> residual, std::span<const double> weights);

  const VibrationRun& run() const { return run_; }
  std::size_t groups() const { return values_.size() / (kTogether * run_.size()); }
  /// `kTogether` values a sample; those of channels that there are not are zero.
  const double* Of(std::size_t group) const { return values_.data() + group * kTogether * run_.size(); }

 private:
  const VibrationRun& run_;
  std::vector<double> values_;
};

/// Of a few channels: real parts, then imaginary parts.
using InCommon = std::array<double, 2 * SideBySide::kTogether>;

/// A segment of samples, from the last one to the first: common = common · step + value.
/// @param common  gets what each sample has; the last one's goes on from `state`, which becomes the first
///   one's
void FilterBackwards(const double* values, std::size_t samples, std::complex<double> step, InCommon& state,
                     InCommon* common);

/// What a response that begins at a sample has in common with the residual from there on, for every sample
/// from the last to the first.
/// @param step  what the response is turned and damped by from sample to sample
/// @param take  (first of the channels, sample, in common)
template <typename Take>
void MatchBackwards(const SideBySide& residual, std::complex<double> step, const Take& take) {
  constexpr std::size_t kSegment = 256;  // samples, which the first cache holds
  std::array<InCommon, kSegment> common;
  for (std::size_t group = 0; group < residual.groups(); ++group) {
    InCommon state{};
    for (std::size_t end = residual.run().size(); end > 0;) {
      const std::size_t first = end > kSegment ? end - kSegment : 0;
      FilterBackwards(residual.Of(group) + first * SideBySide::kTogether, end - first, step, state,
                      common.data());
      for (std::size_t i = end; i-- > first;) take(group * SideBySide::kTogether, i, common[i - first]);
      end = first;
    }
  }
}

/// Sample of one run at which a response of this frequency and damping explains most of a residual, all
/// channels together, the drop of the sum of squares that it brings, and its height in units of the gains.
struct Transient {
  std::size_t sample{};
  double drop{};
  double height{1.0};
};
/// @param gains  of the channels, where they are known; each has its own where this is empty.
Transient LargestTransient(const SideBySide& residual, double resonance_Hz, double damping_ratio,
                           std::span<const double> gains = {});

/// How far the drops that responses of this frequency and damping bring exceed one, added up: the largest in
/// each time in which a response dies away.
double TransientPower(const SideBySide& residual, double resonance_Hz, double damping_ratio, double least);

/// A train at its best phase.
struct TrainMatch {
  double power{};   // half the drop of the sum of squares that it brings, in variances of the noise
  double phase{};   // as ImpulseTrain has it
  double cosine{};  // of the modulation
  double sine{};
};

/// The phase at which a train of this order, resonance and damping explains most of a residual of one run,
/// over its channels together, with the size of a change of its impulses.
/// @param sideband  order of the change; 0 for even impulses
/// @param variance  of the noise
TrainMatch MatchTrain(const SideBySide& residual, const ImpulseTrain& train, double sideband,
                      double variance);

}  // namespace strainwave::analysis::diagnosis
