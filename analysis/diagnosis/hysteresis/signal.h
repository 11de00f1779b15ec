// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// What rounding to steps adds to a signal of which more than this share of neighbours read the same:
/// step/√12, rms; 0 where fewer do.
double RoundingNoise(std::span<const double> signal, double share);

/// Standard deviation of the white part of a signal from its fourth differences over time, so that ramps,
/// corners and smooth curves do not count, evenly sampled or not; rounding included. 0 below 6 values.
/// @param time_s  never falling.
double SampleNoise(std::span<const double> time_s, std::span<const double> signal);

/// The times of a record's samples, or, where torque and angle together are smoother over the samples'
/// numbers, even ones: then the stamps jitter and the samples did not. A gap stays one.
std::vector<double> TimesOfSamples(std::span<const double> time_s, std::span<const double> torque,
                                   std::span<const double> angle);

/// A signal with its white noise taken off.
struct CleanSignal {
  std::vector<double> values;
  std::vector<double> errors;  // standard errors; 0 where there is no noise
};

/// The signal without its white noise: at each sample the parabola over the longest segment, to its left, its
/// right or both, over which parabolas of all lengths agree within the noise. Corners and reversals stay
/// where they are.
/// @param time_s  rising; the abscissa of the parabolas.
/// @param noise   standard deviation; 0 returns the signal.
/// @param breaks  rising; samples after which the signal is known to go on otherwise.
/// Source: intersection of confidence intervals, Katkovnik, IEEE Trans. Signal Process. 47 (1999) 2567.
CleanSignal WithoutNoise(std::span<const double> time_s, std::span<const double> signal, double noise,
                         std::span<const std::size_t> breaks = {});

/// Slope of the signal on the way to each sample from the one before, from lines through as many samples as
/// it takes for noise to be a twentieth of the usual slope, on one side of corners, breaks and gaps; of the
/// first sample the slope behind it.
/// @param time_s  never falling.
/// @param noise   standard deviation; 0 takes the two samples alone.
/// @param breaks  rising; samples after which the signal is known to go on otherwise.
std::vector<double> SlopesWithoutNoise(std::span<const double> time_s, std::span<const double> signal,
                                       double noise, std::span<const std::size_t> breaks);

/// Single samples that stand off the line through their neighbours by more than noise and by more than the
/// signal turns there.
/// @param time_s  rising.
std::vector<std::size_t> LoneSpikes(std::span<const double> time_s, std::span<const double> signal,
                                    double noise);

/// By how much `response` follows the fluctuation of `drive` from sample to sample: the slope between their
/// fourth differences over time, as a share of `slope`, 0 to 1. 0 where that cannot be told from nothing.
/// @param clean_drive  the drive without its noise.
double FollowedShare(std::span<const double> time_s, std::span<const double> drive,
                     std::span<const double> clean_drive, std::span<const double> response, double slope);

/// A time between two samples at which a signal turns from one straight line into another.
struct Turn {
  std::size_t before{};  // sample that it comes after
  double share{};        // of the time to the next sample, 0 to 1
  double value{};        // of the signal there
};
/// Turns that are sharper than the noise: a ramp that ends between two samples goes further than either of
/// them says.
std::vector<Turn> FindTurns(std::span<const double> time_s, std::span<const double> signal, double noise);

/// Standard deviation of the noise on a signal of straight pieces, first-order autoregressive noise included:
/// from its second differences over 1, 2, 4, 8 and 16 samples, which grow with the distance as far as the
/// noise is autocorrelated. 0 below 40 values.
double LastingNoise(std::span<const double> time_s, std::span<const double> signal);

}  // namespace strainwave::analysis::diagnosis
