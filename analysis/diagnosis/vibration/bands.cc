// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/bands.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A tone that holds this share of a band's power is what the band is.
constexpr double kToneShare = 0.8;
constexpr double kLeastBandExcess = 11.0;
constexpr int kTurnings = 8;  // towards the best direction

// What the channels of one run have in common in a range of cells: sums of their products in step.
class InStep {
 public:
  InStep(const VibrationSpectrum& spectrum, std::size_t run, std::size_t channels, std::size_t from,
         std::size_t to)
      : amplitudes_(static_cast<Index>(channels), static_cast<Index>(to - from)),
        sums_(static_cast<Index>(channels * channels), static_cast<Index>(to - from) + 1) {
    sums_.col(0).setZero();
    std::vector<std::complex<float>> cell(channels);
    for (Index k = 0; k < amplitudes_.cols(); ++k) {
      spectrum.AmplitudesAt(run, static_cast<double>(from + static_cast<std::size_t>(k)) * spectrum.cell(),
                            cell);
      for (std::size_t c = 0; c < channels; ++c) amplitudes_(static_cast<Index>(c), k) = cell[c];
      const MatrixXd products = (amplitudes_.col(k) * amplitudes_.col(k).adjoint()).real();
      sums_.col(k + 1) = sums_.col(k) + products.reshaped();
    }
  }

  struct Direction {
    double power{};  // along it
    VectorXd unit;
  };
  // By powers of the matrix: near enough, and where two directions are alike either will do.
  Direction Best(std::size_t first, std::size_t length) const {
    const Index channels = amplitudes_.rows();
    const VectorXd sum = sums_.col(static_cast<Index>(first + length)) - sums_.col(static_cast<Index>(first));
    const auto products = sum.reshaped(channels, channels);
    Index largest = 0;
    products.diagonal().maxCoeff(&largest);
    VectorXd unit = products.col(largest).normalized();
    for (int turning = 0; turning < kTurnings && channels > 1; ++turning)
      unit = (products * unit).normalized();
    return {unit.dot(products * unit), unit};
  }

  double PowerAlong(const VectorXd& unit, std::size_t cell) const {
    return std::norm(unit.cast<std::complex<double>>().dot(amplitudes_.col(static_cast<Index>(cell))));
  }

 private:
  Eigen::MatrixXcd amplitudes_;  // by channel and cell
  MatrixXd sums_;                // over the cells before, all products of two channels
};

}  // namespace

std::vector<NoiseBand> FindBands(const VibrationResidual& residual, double lowest_Hz, double highest_Hz,
                                 std::size_t count) {
  const VibrationSpectrum& spectrum = residual.over_seconds();
  const std::vector<VibrationRun>& runs = residual.samples().runs;
  const double cell = spectrum.cell();
  const auto from = static_cast<std::size_t>(std::ceil(lowest_Hz / cell));
  const auto to = static_cast<std::size_t>(std::min(highest_Hz, spectrum.highest()) / cell);
  if (to <= from) return {};
  std::vector<InStep> in_step;
  double directions = 0.0;  // to choose from, beside the first
  for (std::size_t r = 0; r < runs.size(); ++r) {
    in_step.emplace_back(spectrum, r, runs[r].channels.size(), from, to);
    directions += static_cast<double>(runs[r].channels.size()) - 1.0;
  }
  std::vector<NoiseBand> bands;
  for (std::size_t length = 6; length < to - from; length += std::max<std::size_t>(1, length / 3)) {
    const double noise = static_cast<double>(runs.size() * length);
    for (std::size_t i = 0; i + length <= to - from; i += std::max<std::size_t>(1, length / 8)) {
      const double centre = (static_cast<double>(from + i) + 0.5 * static_cast<double>(length)) * cell;
      const double width = static_cast<double>(length) * cell;
      // Lightly damped is what is meant: a hump as wide as its frequency is the colour of the noise.
      if (width > 0.7 * centre) continue;
      std::vector<InStep::Direction> along;
      double sum = 0.0;
      for (const InStep& run : in_step) {
        along.push_back(run.Best(i, length));
        sum += along.back().power;
      }
      const double excess = ExcessOf(sum, noise + 0.5 * directions);
      if (!(excess > kLeastBandExcess)) continue;
      double largest = 0.0;
      for (std::size_t k = i; k < i + length; ++k) {
        double power = 0.0;
        for (std::size_t r = 0; r < runs.size(); ++r) power += in_step[r].PowerAlong(along[r].unit, k);
        largest = std::max(largest, power);
      }
      if (largest - static_cast<double>(runs.size()) > kToneShare * (sum - noise)) continue;
      NoiseBand band{excess, centre, width, {}};
      for (std::size_t r = 0; r < runs.size(); ++r) {
        // Twice the power per cell, over all samples.
        const double above = std::max(0.0, along[r].power - static_cast<double>(length));
        const double size = std::sqrt(2.0 * above / static_cast<double>(runs[r].size()));
        for (const double part : along[r].unit) band.sizes.push_back(size * part);
      }
      bands.push_back(std::move(band));
    }
  }
  std::sort(bands.begin(), bands.end(),
            [](const NoiseBand& a, const NoiseBand& b) { return a.excess > b.excess; });
  std::vector<NoiseBand> chosen;
  for (NoiseBand& band : bands) {
    if (chosen.size() == count) break;
    const bool near = std::any_of(chosen.begin(), chosen.end(), [&](const NoiseBand& other) {
      return std::abs(other.centre_Hz - band.centre_Hz) < 0.5 * (other.width_Hz + band.width_Hz);
    });
    if (!near) chosen.push_back(std::move(band));
  }
  return chosen;
}

}  // namespace strainwave::analysis::diagnosis
