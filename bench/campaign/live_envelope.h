// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "bench/campaign/pause.h"
#include "bench/controller/live_extremes.h"
#include "daq/checkpoint_file.h"

namespace strainwave::bench {

/// The live channels over bench time in a bounded number of bins of one width. Each bin has the smallest, the
/// largest and the last of its values, so that a reading that stands out is there with its right value,
/// however many there were beside it.
class Envelope {
 public:
  enum class WhenFull {
    kMergePairs,    // bins become twice as wide: all of the time that went by
    kForgetOldest,  // the newest of it
  };

  /// @throws std::invalid_argument for a width that is not above zero, or fewer than two bins.
  Envelope(std::size_t most_bins, double width_s, WhenFull when_full);
  /// As it was kept. @throws the same; for more bins than may be, too.
  Envelope(std::size_t most_bins, double width_s, WhenFull when_full, double start_s,
           std::vector<LiveExtremes> bins);

  /// Values of about that time. Earlier than the first bin counts as the first bin.
  void Add(double time_s, const LiveExtremes& values);

  double start_s() const { return start_s_; }  // of the first bin
  double width_s() const { return width_s_; }
  std::span<const LiveExtremes> bins() const { return bins_; }

 private:
  void MakeRoom(double time_s);

  std::size_t most_bins_;
  double width_s_;
  WhenFull when_full_;
  double start_s_{};
  std::vector<LiveExtremes> bins_;
};

/// What is kept of a campaign: its last minutes, and all of it.
struct LiveEnvelopes {
  static constexpr std::size_t kBins = 160;
  static constexpr double kRecentBin_s = 4.0;
  static constexpr double kFirstBin_s = 4.0;

  Envelope recent{kBins, kRecentBin_s, Envelope::WhenFull::kForgetOldest};
  Envelope whole{kBins, kFirstBin_s, Envelope::WhenFull::kMergePairs};
  Moment taken{};  // when they were written
};

/// Keeps them in a file of the campaign, which outlives the run: the next one goes on with it. A write is one
/// system call in place, twice a second of the world's at most; a kill costs what came since the last one.
class LiveEnvelopeFile {
 public:
  /// @param campaign  its id: a file of another one is not gone on with.
  LiveEnvelopeFile(const std::filesystem::path& path, std::uint64_t campaign);
  LiveEnvelopeFile(const LiveEnvelopeFile&) = delete;
  LiveEnvelopeFile& operator=(const LiveEnvelopeFile&) = delete;
  /// Writes what was not written yet.
  ~LiveEnvelopeFile();

  /// @param time_s  bench time of the newest of the values.
  void Add(double time_s, const LiveExtremes& values);

 private:
  void Write() noexcept;

  std::uint64_t campaign_;
  LiveEnvelopes envelopes_;
  std::optional<daq::CheckpointFile> file_;  // none: it cannot be made or written, and nobody sees anything
  bool is_written_{true};
};

/// Of a campaign that runs or has run; nothing where there is none, or none that can be read.
std::optional<LiveEnvelopes> ReadLiveEnvelopes(const std::filesystem::path& path, std::uint64_t campaign);

}  // namespace strainwave::bench
