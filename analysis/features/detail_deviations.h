// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "analysis/wavelets/decomposition.h"

namespace strainwave::analysis::features {

/// How a channel becomes the standard deviations of its details. The study behind names no wavelet.
struct DetailRecipe {
  std::string wavelet{"sym8"};
  wavelets::Border border{wavelets::Border::kSymmetric};
  int levels{8};
  bool logarithm{true};  // natural, of each deviation: a sensor's gain then shifts all alike

  bool operator==(const DetailRecipe&) const = default;
};

/// The most levels whose filters still fit into the signal: ⌊log₂(samples / (filter length − 1))⌋, as
/// PyWavelets counts; 0 where not even one fits.
int MostDetailLevels(std::size_t samples, std::size_t filter_length);

/// The details D1 … DL of a channel, each brought back to the length of the signal without the others, and
/// their standard deviations (over N − 1). D1 is the highest band, from a quarter of the sampling rate to a
/// half; each further one begins an octave lower. Keeps the memory from record to record; one object a
/// thread.
///
/// Source: docs/sources.md#jaber.
class DetailDeviations {
 public:
  /// @throws std::invalid_argument for an unknown wavelet, or levels out of 1 … 30.
  explicit DetailDeviations(DetailRecipe recipe = {});

  const DetailRecipe& recipe() const { return recipe_; }
  std::size_t CountPerChannel() const { return static_cast<std::size_t>(recipe_.levels); }

  /// `CHANNEL.dLEVEL.standard_deviation`, with a logarithm `CHANNEL.dLEVEL.log_standard_deviation`.
  std::vector<std::string> Names(std::span<const std::string> channels) const;

  /// @param signal  two samples or more, finite.
  /// @param out  `CountPerChannel` places. A detail below a millionth of the signal counts as that: what
  /// rounding leaves says nothing.
  /// @throws std::invalid_argument as said.
  void Compute(std::span<const double> signal, std::span<double> out);

  /// The detail of one level alone, as long as the signal.
  /// @throws std::invalid_argument for a level out of 1 … levels, or a signal without a sample.
  std::vector<double> Detail(std::span<const double> signal, int level);

 private:
  // Of the signal that was decomposed last.
  void Rebuild(std::size_t level, std::size_t samples);

  DetailRecipe recipe_;
  wavelets::FilterBank bank_;
  wavelets::Decomposition decomposition_;
  std::vector<double> zeros_;
  std::vector<double> coarse_;
  std::vector<double> fine_;
};

}  // namespace strainwave::analysis::features
