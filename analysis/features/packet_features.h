// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/wavelets/packets.h"

namespace strainwave::analysis::features {

/// Energy and the thirteen statistics of docs/sources.md#lee-2023, table 1, of one series of coefficients.
inline constexpr std::size_t kBandFeatures = 14;
inline constexpr std::array<std::string_view, kBandFeatures> kBandFeatureNames{"energy",
                                                                               "mean",
                                                                               "std",
                                                                               "rms",
                                                                               "skewness",
                                                                               "kurtosis",
                                                                               "shape_factor",
                                                                               "crest_factor",
                                                                               "impulse_factor",
                                                                               "margin_factor",
                                                                               "peak",
                                                                               "peak_to_peak",
                                                                               "shannon_entropy",
                                                                               "log_energy_entropy"};

/// Memory of one thread, used again.
struct BandWorkspace {
  std::vector<double> roots;
  std::vector<double> logs;
};

/// With N values x of a band:
///   energy Σ x²; mean; std by N − 1; rms; skewness and kurtosis, central moments by N over std³, std⁴;
///   shape factor rms / mean|x|; crest factor max|x| / rms (table 1 prints it without the bars that its
///   other rows have); impulse factor max|x| / mean|x|; margin factor max|x| / (mean √|x|)²; peak max|x|;
///   peak to peak; Shannon entropy −Σ x² ln x², of the coefficients themselves as printed; log energy entropy
///   Σ ln x². Where x² is below the smallest normal number, its logarithm is that of this number.
/// A ratio over zero is zero: what a band without any signal has no shape of.
///
/// @param normalised_entropy  Shannon entropy of the shares x² / Σ x², which no gain of the sensor moves.
/// @param out  `kBandFeatures` places.
/// @return how many logarithms were those of the smallest number.
std::size_t BandFeatures(std::span<const double> band, bool normalised_entropy, BandWorkspace& workspace,
                         std::span<double> out);

/// How a channel becomes bands; by default as in docs/sources.md#lee-2023.
struct PacketRecipe {
  std::string wavelet{"db6"};
  wavelets::Border border{wavelets::Border::kSymmetric};
  int levels{3};
  bool normalised_entropy{};
};

/// One leaf of the packets.
struct PacketBand {
  std::string path;            // natural order: "aad"
  std::size_t by_frequency{};  // its place from the lowest band up: W1
  double low_hz{};
  double high_hz{};
};
/// In natural order.
std::vector<PacketBand> PacketBands(int levels, double sample_rate_hz);

/// The features of all leaves of every channel, on their decimated coefficients. Keeps the memory from record
/// to record; one object a thread.
class PacketFeatures {
 public:
  /// @throws std::invalid_argument for an unknown wavelet, or levels out of 1 … 10.
  explicit PacketFeatures(PacketRecipe recipe = {});

  const PacketRecipe& recipe() const { return recipe_; }
  std::size_t CountPerChannel() const { return kBandFeatures << static_cast<unsigned>(recipe_.levels); }
  /// `CHANNEL.PATH.FEATURE`, channel by channel, leaves in natural order.
  std::vector<std::string> Names(std::span<const std::string> channels) const;

  /// @param signal  one channel, at least one sample, finite.
  /// @param out  `CountPerChannel` places.
  /// @return how many logarithms were those of the smallest number.
  /// @throws std::invalid_argument for a value that is not finite or another number of places.
  std::size_t Compute(std::span<const double> signal, std::span<double> out);

 private:
  PacketRecipe recipe_;
  wavelets::FilterBank bank_;
  wavelets::Packets packets_;
  BandWorkspace workspace_;
};

}  // namespace strainwave::analysis::features
