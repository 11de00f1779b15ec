// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/order_bands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/FFT>

#include "analysis/arguments.h"
#include "analysis/features/quick_length.h"
#include "analysis/features/sums.h"

namespace strainwave::analysis::features {
namespace {

constexpr double kTurnsOfSegment = 16.0;
constexpr double kFewestTurns = 4.0;

// Mean square per line of the spectrum, of the mean of segments that overlap by half.
std::vector<double> MeanSquares(std::span<const double> signal, std::size_t length) {
  const double mean = PairwiseSum(signal) / static_cast<double>(signal.size());
  std::vector<double> window(length);
  double window_squares = 0.0;
  for (std::size_t i = 0; i < length; ++i) {
    window[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) /
                                     static_cast<double>(length));
    window_squares += window[i] * window[i];
  }
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<double> segment(length);
  std::vector<std::complex<double>> spectrum;
  std::vector<double> squares(length / 2 + 1, 0.0);
  double segments = 0.0;
  for (std::size_t begin = 0; begin + length <= signal.size(); begin += length / 2) {
    for (std::size_t i = 0; i < length; ++i) segment[i] = window[i] * (signal[begin + i] - mean);
    transform.fwd(spectrum, segment);
    for (std::size_t line = 0; line < squares.size(); ++line) squares[line] += std::norm(spectrum[line]);
    segments += 1.0;
  }
  for (std::size_t line = 0; line < squares.size(); ++line) {
    const double sides = line == 0 || 2 * line == length ? 1.0 : 2.0;
    squares[line] *= sides / (segments * window_squares * static_cast<double>(length));
  }
  return squares;
}

}  // namespace

std::size_t QuickLength(std::size_t length) {
  for (std::size_t size = length - length % 2; size > 2; size -= 2) {
    std::size_t rest = size;
    for (const std::size_t factor : {2U, 3U, 5U}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1) return size;
  }
  return 2;
}

void RequireRisingEdges(const OrderBands& bands) {
  if (bands.edges.size() < 2 || !(bands.edges.front() >= 0.0) ||
      std::ranges::adjacent_find(bands.edges, [](double a, double b) { return !(a < b); }) !=
          bands.edges.end()) {
    throw std::invalid_argument("bands.edges is not a rising series of at least two orders from 0 up");
  }
}

std::vector<double> OrderBandEnergies(std::span<const double> signal, double samples_per_turn,
                                      const OrderBands& bands) {
  RequirePositive("samples_per_turn", samples_per_turn);
  RequireFinite("signal", signal);
  RequireRisingEdges(bands);
  const double turns = static_cast<double>(signal.size()) / samples_per_turn;
  if (turns < kFewestTurns) {
    throw std::invalid_argument(fmt::format(
        "signal has {:.3g} turns of the input shaft (expected at least {:g})", turns, kFewestTurns));
  }
  const std::size_t length =
      QuickLength(static_cast<std::size_t>(std::min(turns, kTurnsOfSegment) * samples_per_turn));
  const std::vector<double> squares = MeanSquares(signal, length);
  std::vector<double> energies(bands.edges.size() - 1, 0.0);
  const double order_per_line = samples_per_turn / static_cast<double>(length);
  for (std::size_t line = 1; line < squares.size(); ++line) {
    const double order = order_per_line * static_cast<double>(line);
    const auto above = std::ranges::upper_bound(bands.edges, order);
    if (above == bands.edges.begin() || above == bands.edges.end()) continue;
    energies[static_cast<std::size_t>(above - bands.edges.begin()) - 1] += squares[line];
  }
  for (std::size_t band = 0; band < energies.size(); ++band) {
    if (bands.edges[band + 1] > 0.5 * samples_per_turn)
      energies[band] = std::numeric_limits<double>::quiet_NaN();
  }
  return energies;
}

std::vector<std::string> OrderBandNames(std::span<const std::string> channels, const OrderBands& bands) {
  std::vector<std::string> names;
  for (const std::string& channel : channels) {
    for (std::size_t band = 0; band + 1 < bands.edges.size(); ++band) {
      names.push_back(fmt::format("{}.orders.{:g}_{:g}", channel, bands.edges[band], bands.edges[band + 1]));
    }
  }
  return names;
}

}  // namespace strainwave::analysis::features
