// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/features/series_features.h"
#include "analysis/wavelets/decomposition.h"

namespace strainwave::analysis::features {

/// How a channel becomes series; by default as in docs/sources.md#shivam-2023.
struct WaveletRecipe {
  std::string wavelet{"sym8"};
  wavelets::Border border{wavelets::Border::kSymmetric};
  int levels{7};
};

/// The features of the approximations of all levels of every channel. Keeps the memory from record to record;
/// one object a thread.
class WaveletFeatures {
 public:
  /// @throws std::invalid_argument for an unknown wavelet, or levels out of 1 … 30.
  explicit WaveletFeatures(WaveletRecipe recipe = {});

  const WaveletRecipe& recipe() const { return recipe_; }
  std::size_t CountPerChannel() const;

  /// `CHANNEL.aLEVEL.COLUMN`, channel by channel, level 1 first, columns in their order.
  std::vector<std::string> Names(std::span<const std::string> channels) const;

  /// @param signal  one channel, at least one sample, finite.
  /// @param out  `CountPerChannel` places.
  /// @throws std::invalid_argument as said.
  void Compute(std::span<const double> signal, std::span<double> out);

 private:
  WaveletRecipe recipe_;
  wavelets::FilterBank bank_;
  wavelets::Decomposition decomposition_;
  SeriesWorkspace series_;
};

}  // namespace strainwave::analysis::features
