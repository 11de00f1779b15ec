// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "analysis/diagnosis/vibration/samples.h"

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

/// Product of finite numbers: the operator looks for infinities.
inline std::complex<double> Product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// What a ring that begins at a sample has in common with the residual from there on, for every sample from
/// the last to the first, and for a few channels at a time: each is a chain of products that wait for one
/// another, and several run side by side in the time of one.
/// @param step  what the ring is turned and damped by from sample to sample
/// @param take  (channel, sample, in common)
template <typename Take>
void MatchBackwards(const VibrationRun& run, std::complex<double> step, std::span<const double> residual,
                    std::span<const double> weights, const Take& take) {
  constexpr std::size_t kTogether = 4;
  const auto match = [&]<std::size_t kChannels>(std::size_t first,
                                                std::integral_constant<std::size_t, kChannels>) {
    std::array<std::complex<double>, kChannels> common{};
    for (std::size_t i = run.size(); i-- > 0;) {
      for (std::size_t c = 0; c < kChannels; ++c) {
        const std::size_t place = run.channels[first + c].first + i;
        common[c] = Product(common[c], step) + (weights[place] > 0.0 ? residual[place] : 0.0);
        take(first + c, i, common[c]);
      }
    }
  };
  std::size_t first = 0;
  for (; first + kTogether <= run.channels.size(); first += kTogether)
    match(first, std::integral_constant<std::size_t, kTogether>());
  for (; first < run.channels.size(); ++first) match(first, std::integral_constant<std::size_t, 1>());
}

/// Of a resonance that rings: exp(pole · t) is what is left of it after a time, turned.
std::complex<double> RingPole(double ring_Hz, double damping_ratio);

/// A change of the impulses with the input angle: 1 + cosine · cos(order θ) + sine · sin(order θ).
struct RingModulation {
  double order{};
  double cosine{};
  double sine{};
};

/// Impulses at even angles, but for what they slip, each of which lets a resonance ring:
/// ∑ⱼ wⱼ exp(−ζω(t − tⱼ)) sin ω(t − tⱼ).
struct RingTrain {
  double order{};  // impulses per input turn
  double ring_Hz{};
  double damping_ratio{};
  double phase{};  // impulse where angle from mid-record · order / 2π = integer + phase
  std::vector<RingModulation> modulations{};
  /// By how much of a period each impulse comes late, the one at mid-record in the middle; those beyond the
  /// ends as the last ones. Empty where none slips.
  std::vector<double> slips{};

  double SlipOf(double impulse) const;
};

/// The train with impulses of about one.
Eigen::VectorXd RingColumn(const VibrationRun& run, const RingTrain& train);

/// Adds a single ring that starts at a time.
void AddKick(const VibrationRun& run, double ring_Hz, double damping_ratio, double start_s, double height,
             Eigen::Ref<Eigen::VectorXd> column);

/// A single ring of a sum of them, and its height there.
struct Knock {
  double start_s{};
  double height{1.0};
};

/// The ring, about as late as the first of two of this frequency and damping, that both together are once
/// both have begun.
Knock OneOf(const Knock& first, const Knock& second, double ring_Hz, double damping_ratio);

/// Sample of one run at which a ring of this frequency and damping explains most of a residual, all channels
/// together, the drop of the sum of squares that it brings, and its height in units of the gains.
struct Kick {
  std::size_t sample{};
  double drop{};
  double height{1.0};
};
/// @param gains  of the channels, where they are known; each has its own where this is empty.
Kick LoudestKick(const VibrationRun& run, double ring_Hz, double damping_ratio,
                 std::span<const double> residual, std::span<const double> weights,
                 std::span<const double> gains = {});

/// How far the drops that rings of this frequency and damping bring exceed one, added up: the largest in each
/// time in which a ring dies away.
double KickPower(const VibrationRun& run, double ring_Hz, double damping_ratio,
                 std::span<const double> residual, std::span<const double> weights, double least);

/// A train at its best place.
struct TrainMatch {
  double power{};   // half the drop of the sum of squares that it brings, in variances of the noise
  double phase{};   // as RingTrain has it
  double cosine{};  // of the modulation
  double sine{};
};

/// The place at which a train of this order, ring and damping explains most of a residual of one run, over
/// its channels together, with the size of a change of its impulses.
/// @param sideband  order of the change; 0 for even impulses
/// @param variance  of the noise
TrainMatch MatchTrain(const VibrationRun& run, const RingTrain& train, double sideband,
                      std::span<const double> residual, std::span<const double> weights, double variance);

}  // namespace strainwave::analysis::diagnosis
