// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/envelope_orders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/FFT>

#include "analysis/arguments.h"
#include "analysis/features/envelope_prominence.h"
#include "analysis/features/quick_length.h"

namespace strainwave::analysis::features {
namespace {

constexpr double kFewestEnvelopeTurns = 4.0;
constexpr double kLowestCarrier = 1.0 / 12.0;  // of the Nyquist frequency
constexpr double kLeastBandShare = 1e-12;
constexpr double kHighestOrder = 20.0;

// Magnitude of the analytic signal of what lies above the lowest carrier.
std::vector<double> EnvelopeOf(std::span<const double> signal) {
  const std::size_t n = signal.size();
  Eigen::FFT<double> transform;
  std::vector<std::complex<double>> values(signal.begin(), signal.end());
  std::vector<std::complex<double>> spectrum;
  transform.fwd(spectrum, values);
  const auto lowest = static_cast<std::size_t>(std::ceil(kLowestCarrier * static_cast<double>(n) / 2.0));
  for (std::size_t line = 0; line < n; ++line) {
    const bool carrier = line >= lowest && 2 * line < n;
    spectrum[line] = carrier ? 2.0 * spectrum[line] : 0.0;
  }
  transform.inv(values, spectrum);
  std::vector<double> envelope(n);
  std::ranges::transform(values, envelope.begin(), [](const auto& value) { return std::abs(value); });
  return envelope;
}

// Powers of the envelope's lines, under a Hann window over all of the record.
struct EnvelopeSpectrum {
  std::vector<double> squares;
  double order_per_line{};
};

EnvelopeSpectrum SpectrumOf(std::span<const double> signal, double samples_per_turn) {
  const double turns = static_cast<double>(signal.size()) / samples_per_turn;
  // A turn that was cut off by a sample is one all the same.
  if (turns < kFewestEnvelopeTurns - 1e-3)
    throw std::invalid_argument(fmt::format(
        "signal has {:.3g} turns of the input shaft (expected at least {:g})", turns, kFewestEnvelopeTurns));
  const std::size_t length = QuickLength(signal.size());
  std::vector<double> envelope = EnvelopeOf(signal.first(length));
  double mean = 0.0;
  for (const double value : envelope) mean += value / static_cast<double>(length);
  for (std::size_t i = 0; i < length; ++i) {
    const double phase =
        2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(length);
    envelope[i] = (envelope[i] - mean) * (0.5 - 0.5 * std::cos(phase));
  }
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<std::complex<double>> lines;
  transform.fwd(lines, envelope);
  EnvelopeSpectrum spectrum{.squares = {}, .order_per_line = samples_per_turn / static_cast<double>(length)};
  for (const auto& line : lines) spectrum.squares.push_back(std::norm(line));
  return spectrum;
}

}  // namespace

OrderBands EnvelopeOrderBands(double samples_per_turn) {
  RequirePositive("samples_per_turn", samples_per_turn);
  OrderBands bands{.edges = {0.25}};
  for (double edge = 0.75; edge <= kHighestOrder + 0.25 && edge <= 0.5 * samples_per_turn; edge += 0.5)
    bands.edges.push_back(edge);
  if (bands.edges.size() < 3) bands.edges.clear();
  return bands;
}

std::vector<double> EnvelopeOrderShares(std::span<const double> signal, double samples_per_turn,
                                        const OrderBands& bands) {
  RequirePositive("samples_per_turn", samples_per_turn);
  RequireFinite("signal", signal);
  RequireRisingEdges(bands);
  const EnvelopeSpectrum spectrum = SpectrumOf(signal, samples_per_turn);
  std::vector<double> shares(bands.edges.size() - 1, 0.0);
  double all = 0.0;
  for (std::size_t line = 1; line < spectrum.squares.size(); ++line) {
    const double order = spectrum.order_per_line * static_cast<double>(line);
    const auto above = std::ranges::upper_bound(bands.edges, order);
    if (above == bands.edges.begin() || above == bands.edges.end()) continue;
    const double square = spectrum.squares[line];
    shares[static_cast<std::size_t>(above - bands.edges.begin()) - 1] += square;
    all += square;
  }
  for (std::size_t band = 0; band < shares.size(); ++band) {
    const bool reached = bands.edges[band + 1] <= 0.5 * samples_per_turn;
    const double share = all > 0.0 ? shares[band] / all : 0.0;
    shares[band] =
        reached ? std::log(std::max(share, kLeastBandShare)) : std::numeric_limits<double>::quiet_NaN();
  }
  return shares;
}

std::vector<double> EnvelopeProminences_dB(std::span<const double> signal, double samples_per_turn,
                                           std::span<const double> orders) {
  RequirePositive("samples_per_turn", samples_per_turn);
  RequireFinite("signal", signal);
  const EnvelopeSpectrum spectrum = SpectrumOf(signal, samples_per_turn);
  constexpr double kSlip = 0.02;
  constexpr double kNeighbours = 0.2;
  // Fewer say nothing of what is usual.
  constexpr std::size_t kFewestNeighbours = 8;
  std::vector<double> prominences_dB;
  for (const double order : orders) {
    RequirePositive("orders", order);
    // Its own line, and two to either side, are one under the window.
    const double reach = std::max(kSlip * order, 2.0 * spectrum.order_per_line);
    double strongest = 0.0;
    std::vector<double> neighbours;
    for (std::size_t line = 1; line < spectrum.squares.size(); ++line) {
      const double off = std::abs(spectrum.order_per_line * static_cast<double>(line) - order);
      if (off <= reach) {
        strongest = std::max(strongest, spectrum.squares[line]);
      } else if (off <= kNeighbours * order) {
        neighbours.push_back(spectrum.squares[line]);
      }
    }
    const bool told = neighbours.size() >= kFewestNeighbours && 1.2 * order <= 0.5 * samples_per_turn;
    if (!told) {
      prominences_dB.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const auto middle = neighbours.begin() + static_cast<std::ptrdiff_t>(neighbours.size() / 2);
    std::ranges::nth_element(neighbours, middle);
    constexpr double kLeast = std::numeric_limits<double>::min();
    prominences_dB.push_back(10.0 * std::log10(std::max(strongest, kLeast) / std::max(*middle, kLeast)));
  }
  return prominences_dB;
}

std::vector<std::string> EnvelopeOrderNames(std::span<const std::string> channels, const OrderBands& bands) {
  std::vector<std::string> names;
  for (const std::string& channel : channels) {
    for (std::size_t band = 0; band + 1 < bands.edges.size(); ++band)
      names.push_back(
          fmt::format("{}.envelope_orders.{:g}_{:g}", channel, bands.edges[band], bands.edges[band + 1]));
  }
  return names;
}

}  // namespace strainwave::analysis::features
