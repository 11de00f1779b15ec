// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "bench/controller/sample_alignment.h"
#include "daq/acquisition/channel_skew.h"

namespace strainwave::bench {

/// Time between the two encoders that their devices' times do not tell, from samples in motion
/// (docs/effects.md E20): the output read s later,
///
///   input / ratio − output = −s ω + l a + c T + h d + Σ harmonics of input and output (1, 2) + constant,
///
/// T the torque at the output, whose twist goes by direction as the skew does and would be taken for it; d
/// the direction, by which the gear's lost motion goes whether it moves or stands; ω and a the output's own
/// speed and acceleration from its angles before and after. The input's speed would not do: the output swings
/// on the gear's spring, in short moves by 2 % of the speed, and a drive tells its speed milliseconds late.
/// Moves of either direction and to several angles, each with the standstill after it,
/// tell them apart. Readings have to be closer together than a tenth of a move and than half a period of the
/// swing (some 50 Hz), so that differences are speeds.
class EncoderSkew {
 public:
  explicit EncoderSkew(double ratio) : ratio_(ratio) {}

  /// @param direction  1 or -1. What the fit misses of the readings within a move is alike, so that each move
  ///   counts as one reading.
  void BeginMove(double direction) noexcept;
  /// The next sample of the move and of the standstill after it. Takes no memory.
  void Add(const AlignedSample& sample) noexcept;

  /// Above zero: the output encoder is read later. Nothing where too little moved to tell.
  std::optional<daq::acquisition::Skew> Estimate() const;

 private:
  static constexpr std::size_t kUnknowns = 13;

  void Take(const AlignedSample& before, const AlignedSample& at, const AlignedSample& after) noexcept;

  double ratio_;
  double direction_{1.0};
  std::array<AlignedSample, 2> last_{};  // the newest last
  int in_move_{};
  bool begun_{};
  double first_rad_{};  // of the difference, taken off so that no digits are lost
  std::size_t count_{};
  std::size_t moves_{};
  std::array<double, kUnknowns * kUnknowns> normal_{};
  std::array<double, kUnknowns> right_{};
  double squares_{};
  double speeds_rad_per_s_{};
};

}  // namespace strainwave::bench
