// SPDX-License-Identifier: Apache-2.0
#include "analysis/joint_dynamics/savitzky_golay.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/QR>

namespace strainwave::analysis::joint_dynamics {
namespace {

// Of each sample: the rows of `weights` for the first and last half window, its middle row between.
std::vector<double> Filtered(const Eigen::MatrixXd& weights, std::span<const double> series, double scale) {
  const auto window = static_cast<std::size_t>(weights.rows());
  const std::size_t count = series.size();
  if (count < window)
    throw std::invalid_argument(
        fmt::format("a series of {} samples for a window of {} (expected as many or more)", count, window));
  const std::size_t half = window / 2;
  const Eigen::Map<const Eigen::VectorXd> values(series.data(), static_cast<Eigen::Index>(count));
  const auto width = static_cast<Eigen::Index>(window);
  const Eigen::VectorXd middle = weights.row(static_cast<Eigen::Index>(half)).transpose();
  std::vector<double> filtered(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = i < half ? 0 : std::min(i - half, count - window);
    const auto row = static_cast<Eigen::Index>(i - first);
    const auto part = values.segment(static_cast<Eigen::Index>(first), width);
    filtered[i] = scale * (i - first == half ? middle.dot(part) : weights.row(row).dot(part));
  }
  return filtered;
}

}  // namespace

SavitzkyGolay MakeSavitzkyGolay(int window, int order) {
  if (window % 2 == 0 || order < 1 || window <= order)
    throw std::invalid_argument(
        fmt::format("a window of {} samples and the order {} (expected an odd window above the order, and an "
                    "order from 1 up)",
                    window, order));
  const int half = window / 2;
  // Powers of −1 … 1: those of sample numbers would lose all digits.
  Eigen::MatrixXd powers(window, order + 1);
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(window, order + 1);
  for (int k = 0; k < window; ++k) {
    const double x = static_cast<double>(k - half) / half;
    powers(k, 0) = 1.0;
    for (int p = 1; p <= order; ++p) {
      powers(k, p) = powers(k, p - 1) * x;
      slopes(k, p) = p * powers(k, p - 1) / half;
    }
  }
  const Eigen::MatrixXd coefficients =
      powers.colPivHouseholderQr().solve(Eigen::MatrixXd::Identity(window, window));
  return {window, order, powers * coefficients, slopes * coefficients};
}

std::vector<double> Smoothed(const SavitzkyGolay& filter, std::span<const double> series) {
  return Filtered(filter.smoothing, series, 1.0);
}

std::vector<double> Derivative(const SavitzkyGolay& filter, std::span<const double> series, double step_s) {
  return Filtered(filter.slope, series, 1.0 / step_s);
}

double ResponseAt(const SavitzkyGolay& filter, double cycles_per_sample) {
  const int half = filter.window / 2;
  double sum = 0.0;
  for (int k = 0; k < filter.window; ++k)
    sum += filter.smoothing(half, k) * std::cos(2.0 * std::numbers::pi * cycles_per_sample * (k - half));
  return sum;
}

double HalfPowerFrequency(const SavitzkyGolay& filter) {
  const double half_power = std::sqrt(0.5);
  // The response falls from 1 through its first zero, below two cycles a window for each power.
  const double step = 0.01 / filter.window;
  double low = 0.0;
  while (low < 0.5 && ResponseAt(filter, low + step) > half_power) low += step;
  double high = low + step;
  if (high >= 0.5) return 0.5;
  constexpr int kHalvings = 40;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (ResponseAt(filter, middle) > half_power ? low : high) = middle;
  }
  return low;
}

}  // namespace strainwave::analysis::joint_dynamics
