// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "analysis/diagnosis/vibration/samples.h"

namespace strainwave::analysis::diagnosis {

/// What a spectrum runs over: turns of the input shaft, or seconds.
enum class SpectrumAxis { kTurns, kSeconds };

/// Power of a residual over orders (or Hz), each channel divided by its own smooth background and summed: one
/// a channel is what noise of any slow colour gives. For searches; fits decide.
///
/// Samples without weight count as zero. Where the axis is not evenly sampled (changing speed, gaps) the
/// residual is interpolated first.
class VibrationSpectrum {
 public:
  VibrationSpectrum(const VibrationSamples& samples, std::span<const double> residual,
                    std::span<const double> weights, SpectrumAxis axis);

  /// Sum over channels at an order; 0 beyond half the sampling rate.
  double At(double order) const noexcept;
  std::size_t channels() const noexcept { return channels_; }
  /// Amplitudes of the channels of one run at an order, with At()'s sum of squares.
  void AmplitudesAt(std::size_t run, double order, std::span<std::complex<float>> amplitudes) const noexcept;
  double highest() const noexcept { return highest_; }
  /// Width of a resolution cell: one over the length of the longest record.
  double cell() const noexcept { return cell_; }
  /// Distance of orders at which At() knows more: a quarter cell or less.
  double step() const noexcept { return step_; }

 private:
  struct Run {
    double step{};
    double per_step{};
    std::vector<float> power;
    std::vector<std::vector<std::complex<float>>> of_channel;
  };
  std::vector<Run> runs_;
  std::size_t channels_{};
  double highest_{};
  double cell_{};
  double step_{};
};

/// Standard deviation of the noise of an evenly sampled signal without its lines: from the smooth background
/// of its spectrum.
double BroadbandDeviation(std::span<const double> values);

/// Correlation of the noise of two such signals of equal length, without their lines: that of their sum
/// against that of their difference, all frequencies alike whatever the colour.
double BroadbandCorrelation(std::span<const double> a, std::span<const double> b);

/// A peak of a spectrum.
struct SpectrumPeak {
  double order{};
  double power{};
};

/// The strongest peaks between two orders, at least a cell apart, refined by a parabola.
std::vector<SpectrumPeak> FindPeaks(const VibrationSpectrum& spectrum, double lowest, double highest,
                                    std::size_t count);

/// How unlikely it is that `cells` cells of noise reach this mean: −ln p, about (large deviations of a sum of
/// exponential variates); 0 below the mean that noise has.
double ExcessOf(double sum, double cells) noexcept;

}  // namespace strainwave::analysis::diagnosis
