// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "bench/roles/sampler.h"
#include "daq/acquisition/channel_skew.h"

namespace strainwave::bench {

/// Time between the two encoders, from readings in motion (E20): with the output read later by s,
///
///   input / ratio − output = −s ω + c T + Σ harmonics of the wave generator (1, 2) + constant,
///
/// ω the output's speed, T the torque at the output, whose twist goes by direction as the skew does and would
/// be taken for it. Moves of either direction and of several angles of the wave generator tell them apart.
class EncoderSkew {
 public:
  explicit EncoderSkew(double ratio) : ratio_(ratio) {}

  /// A reading while the shafts move. Takes no memory.
  void Add(const Readings& readings) noexcept;
  /// A move has ended: what the fit misses of the readings within one is alike, so that each counts as one.
  void EndMove() noexcept { ++moves_; }

  /// Above zero: the output encoder is read later. Nothing where too little moved to tell.
  std::optional<daq::acquisition::Skew> Estimate() const;

 private:
  static constexpr std::size_t kUnknowns = 7;

  double ratio_;
  bool begun_{};
  double first_rad_{};  // of the difference, taken off so that no digits are lost
  std::size_t count_{};
  std::size_t moves_{};
  std::array<double, kUnknowns * kUnknowns> normal_{};
  std::array<double, kUnknowns> right_{};
  double squares_{};
};

}  // namespace strainwave::bench
