// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "daq/acquisition/sample_source.h"

namespace strainwave::daq::acquisition {

struct DecimatorSettings {
  unsigned factor{1};         // samples in for one out
  double pass_band{0.8};      // of half the new rate: up to here nothing is touched and nothing folds in
  double attenuation_db{80};  // of what would fold into the pass band; the ripple there is as small
};

/// Taps of the linear-phase low-pass, an odd number of them with sum one: a Kaiser window by the formulas of
/// Kaiser (1974), pass band up to pass_band / (2 factor), stop band from (2 - pass_band) / (2 factor) of the
/// old rate, whatever lies between folds only into what lies above the pass band.
/// @throws std::invalid_argument for a factor of zero, a pass band not within (0, 1), or an attenuation
///   outside 21 to 140 dB.
std::vector<double> DecimationTaps(const DecimatorSettings& settings);

/// Lowers the rate of a stream of blocks. The delay of the filter is taken off: output n, counted by
/// `first_sample`, is the signal at the moment of input n times `factor`, and device times say the same. The
/// outputs stand on that grid also after a gap; one whose taps would reach over a gap is left out, and is
/// part of `lost_before`.
class Decimator {
 public:
  /// All memory is taken here. @throws std::invalid_argument as above.
  Decimator(const SourceDescription& source, const DecimatorSettings& settings);

  /// What comes out: float32 at the lower rate, in the unit of the raw values.
  const SourceDescription& description() const { return description_; }

  /// Input samples to each side that an output rests on: so much later than its moment it comes out.
  std::uint64_t delay_samples() const { return taps_.size() / 2; }

  /// Takes a block that a `GapLedger` has seen and writes the outputs it completes; `out` has room for
  /// `description().most_samples_a_block`, and has no samples where none is complete.
  /// @throws std::invalid_argument if the block has other channels than the source; std::length_error if it
  ///   is longer than the source said.
  void Decimate(const SampleBlock& block, SampleBlock& out);

 private:
  void Filter(std::uint64_t centre, SampleBlock& out);

  SourceDescription source_;
  SourceDescription description_;
  unsigned factor_;
  std::vector<double> taps_;
  std::vector<double> frames_;  // the newest inputs without a gap, sample after sample
  std::vector<double> sums_;
  std::size_t kept_{};           // samples in it
  std::uint64_t next_input_{};   // running number of the sample after the last kept one
  std::uint64_t next_output_{};  // that is due
  bool has_begun_{};
  std::uint64_t skipped_{};  // outputs since the last one that came out
};

}  // namespace strainwave::daq::acquisition
