// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/kernel.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr int kFlatness = 6;                    // terms of the exponential series that are kept
constexpr double kWidth = 2.9918 / kHalfPower;  // σ of the Gaussian in it, over the header's
constexpr double kKernelReach = 6.0 * kWidth;   // σ

// The kernel's derivative: Σⱼ (−½)ʲ/j! · σ²ʲ · G⁽²ʲ⁺ᵏ⁾, with G⁽ⁿ⁾ = (−1)ⁿ Heₙ(u) G / σⁿ.
double KernelValue(double time_s, double header_sigma_s, int derivative) {
  const double sigma_s = kWidth * header_sigma_s;
  const double u = time_s / sigma_s;
  std::array<double, 2 * kFlatness + 2> hermite{};
  hermite[0] = 1.0;
  hermite[1] = u;
  for (std::size_t n = 2; n < hermite.size(); ++n) {
    hermite[n] = u * hermite[n - 1] - static_cast<double>(n - 1) * hermite[n - 2];
  }
  double sum = 0.0;
  double factor = 1.0;
  for (int j = 0; j < kFlatness; ++j) {
    sum += factor * hermite[static_cast<std::size_t>(2 * j + derivative)];
    factor *= -0.5 / (j + 1);
  }
  const double gauss = std::exp(-0.5 * u * u) / (std::sqrt(kTwoPi) * sigma_s);
  return (derivative % 2 == 0 ? 1.0 : -1.0) * sum * gauss / std::pow(sigma_s, derivative);
}

// Lends taps what the cut tails took: the `derivative`th derivative of 1, t and t² comes out exact. Tails are
// thin, but the square of the time is large where they are: without it an acceleration is 0.06 % too large.
void MakeExactForParabolas(std::span<double> taps, std::span<const double> offsets_s, double sigma_s,
                           int derivative) {
  Eigen::Matrix3d lent = Eigen::Matrix3d::Zero();  // moments of e^(−u²/2)·(1, u, u²)
  Eigen::Vector3d missing = Eigen::Vector3d::Zero();
  missing(derivative) = std::tgamma(derivative + 1.0) / std::pow(sigma_s, derivative);
  const auto powers = [&](double offset_s) {
    const double u = offset_s / sigma_s;
    return Eigen::Vector3d(1.0, u, u * u);
  };
  const auto bell = [&](double offset_s) { return std::exp(-0.5 * std::pow(offset_s / sigma_s, 2)); };
  for (std::size_t k = 0; k < taps.size(); ++k) {
    const Eigen::Vector3d moments = powers(offsets_s[k]);
    missing -= taps[k] * moments;
    lent += bell(offsets_s[k]) * moments * moments.transpose();
  }
  const Eigen::Vector3d amounts = lent.ldlt().solve(missing);
  for (std::size_t k = 0; k < taps.size(); ++k)
    taps[k] += bell(offsets_s[k]) * amounts.dot(powers(offsets_s[k]));
}

}  // namespace

double KernelTaps::At(std::span<const double> samples, std::size_t sample) const {
  const auto count = static_cast<Eigen::Index>(taps.size());
  return Eigen::Map<const Eigen::VectorXd>(taps.data(), count)
      .dot(Eigen::Map<const Eigen::VectorXd>(samples.data() + (sample - reach), count));
}

KernelTaps MakeKernel(double sigma_s, double step_s, int derivative, double shift_s) {
  KernelTaps kernel;
  kernel.reach = static_cast<std::size_t>(std::ceil((kKernelReach * sigma_s + std::abs(shift_s)) / step_s));
  kernel.taps.resize(2 * kernel.reach + 1);
  std::vector<double> offsets_s(kernel.taps.size());
  for (std::size_t k = 0; k < kernel.taps.size(); ++k) {
    offsets_s[k] = (static_cast<double>(k) - static_cast<double>(kernel.reach)) * step_s - shift_s;
    kernel.taps[k] = step_s * KernelValue(-offsets_s[k], sigma_s, derivative);
  }
  MakeExactForParabolas(kernel.taps, offsets_s, kWidth * sigma_s, derivative);
  return kernel;
}

KernelTaps MakeBandKernel(double sigma_s, double step_s, int derivative) {
  KernelTaps band = MakeKernel(std::numbers::sqrt2 * sigma_s, step_s, derivative);
  const KernelTaps narrow = MakeKernel(sigma_s, step_s, derivative);
  for (double& tap : band.taps) tap = -tap;
  for (std::size_t k = 0; k < narrow.taps.size(); ++k)
    band.taps[band.reach - narrow.reach + k] += narrow.taps[k];
  return band;
}

double NoiseGain(const KernelTaps& kernel) {
  double sum = 0.0;
  for (const double tap : kernel.taps) sum += tap * tap;
  return std::sqrt(sum);
}

}  // namespace strainwave::analysis::diagnosis
