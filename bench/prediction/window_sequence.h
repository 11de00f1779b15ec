// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "bench/prediction/signal_settings.h"

namespace strainwave::bench {

struct Window {
  std::size_t begin{};
  std::size_t count{};
};

/// Samples for one unit of a position that changes evenly, up or down: over each eighth as over the whole, to
/// a hundredth. None where it does not, or of a single sample.
std::optional<double> SamplesPerUnit(std::span<const double> positions);

/// Windows of one length that follow each other, from the first sample on: those that a predictor learns from
/// and those that a monitor predicts from. The sample nearest to the end of a window, on either side, is the
/// next one's first. A window has as many samples as fit whole into its length; of uneven positions, all up
/// to the next one.
class WindowSequence {
 public:
  /// @param length  of a window, in the unit of the positions: samples, or turns of a shaft.
  explicit WindowSequence(double length) : length_(length) {}

  /// Takes the next sample, which is no less far than those before.
  /// @return the window that ends with the sample before it, where this one begins another.
  std::optional<Window> Add(double position);

  /// Ends the series. @return the window that holds all its samples though no other one begins.
  std::optional<Window> Finish();

 private:
  std::optional<std::size_t> WholeSamples() const;
  Window Close(std::size_t count);

  double length_;
  double origin_{};
  double ended_{};                 // windows
  std::size_t begin_{};            // of the open window
  std::vector<double> positions_;  // of its samples
};

/// Windows of a record without overlap; what is left at the end is not used. None where the record is shorter
/// than one window.
/// @param samples_per_turn  of the input shaft; needed where the length is in turns.
std::vector<Window> WindowsOf(std::size_t rows, std::optional<double> samples_per_turn,
                              const WindowLength& length);

}  // namespace strainwave::bench
