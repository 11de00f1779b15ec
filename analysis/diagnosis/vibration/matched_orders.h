// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstddef>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "analysis/diagnosis/vibration/speed_band.h"
#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// The residual of the first record, matched to a resonance, over orders of the input angle.
struct MatchedOrders {
  double first{};
  double step{};
  double per_order{};  // bins
  std::vector<std::vector<std::complex<float>>> of_channel;
  std::vector<float> power;  // of all channels
  double relative_noise{};   // of the channels on average, beside white noise
  std::vector<float> noise;  // power that a channel has without impulses; its integral over the orders is one

  double last() const { return first + step * static_cast<double>(power.size() - 1); }
  std::size_t BinOf(double order) const {
    return static_cast<std::size_t>((order - first) * per_order + 0.5);
  }
  std::complex<double> At(std::size_t channel, double order) const {
    const std::size_t bin = BinOf(order);
    return bin < power.size() ? std::complex<double>(of_channel[channel][bin]) : std::complex<double>{};
  }
};

/// Orders, from … to.
struct OrderRange {
  double first{};
  double last{};
};

/// Matches what a model leaves to resonances of one damping, at the speeds of a band.
class ResonanceMatcher {
 public:
  ResonanceMatcher(const VibrationResidual& residual, const SpeedBand& band);

  /// Where a resonance may be observable at the speeds of a band.
  /// @param reach   of sidebands, in orders
  /// @param widest  distance of harmonics in orders: between two of them is a resonance that both are far
  ///   from
  static OrderRange Range(const VibrationRun& run, const SpeedBand& band, double resonance_Hz, double reach,
                          double widest);

  MatchedOrders Match(double resonance_Hz, double reach, double widest);

 private:
  /// The resonance is a Lorentz line over frequency; over orders it is smeared by the speeds.
  void Predict(double natural, double half_width, MatchedOrders& matched) const;
  /// Noise of any colour is as large here as the lines between those of a train say.
  double RelativeNoise(const std::vector<std::complex<double>>& lines, const MatchedOrders& matched);

  const VibrationResidual& residual_;
  const VibrationRun& run_;
  const SpeedBand band_;
  std::vector<double> speeds_rad_per_s_;                     // evenly over the turns of the band
  std::vector<std::vector<std::complex<double>>> filtered_;  // by channel
  std::vector<std::complex<double>> values_;
  std::vector<std::complex<double>> spectrum_;
  std::vector<double> ratios_;
  Eigen::FFT<double> transform_;
};

}  // namespace strainwave::analysis::diagnosis
