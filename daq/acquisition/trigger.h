// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daq/acquisition/sample_source.h"

namespace strainwave::daq::acquisition {

enum class TriggerKind : std::uint8_t {
  kAbove,    // at or above the level, also where the signal begins there
  kBelow,    //
  kRising,   // reaches the level from below
  kFalling,  // from above
  kEvent,    // none of the signal: only what `Fire()` says
};

struct TriggerSettings {
  TriggerKind kind{};
  std::size_t channel{};
  double level{};            // in raw values
  double hysteresis{};       // the signal must go back so far beyond the level before it can trigger again
  std::uint64_t before{};    // samples kept from before the trigger
  std::uint64_t after{};     // samples from behind it
  std::uint64_t hold_off{};  // samples from one trigger to the next at least
};

/// What was around a trigger.
struct Capture {
  struct Hole {
    std::uint64_t row{};   // of the capture, the one after it
    std::uint64_t lost{};  // samples
  };
  std::string cause{};
  std::uint64_t trigger_sample{};  // running number
  std::uint64_t first_sample{};    // of row 0
  std::uint64_t trigger_row{};  // fewer than `before` if the stream had just begun; `rows()`: none came after
  std::uint32_t channels{};
  SampleType type{};
  double rate_hz{};
  std::vector<std::uint32_t> words{};  // raw, sample after sample
  std::vector<Hole> holes{};           // in the order of rows
  struct Piece {
    std::uint64_t row{};
    BlockHeader header{};  // of what lies within the capture
  };
  std::vector<Piece> pieces{};  // the blocks that the samples came in

  std::uint64_t rows() const { return words.size() / channels; }
  double Value(std::uint64_t row, std::size_t channel) const {
    return SampleBlock::ValueOf(words[row * channels + channel], type);
  }
};

/// Keeps the last samples of a stream and hands over those around a trigger, whole, wherever the borders of
/// blocks lie. Triggers while a capture is running or held off are counted and do not begin another.
class TriggeredCapture {
 public:
  /// @throws std::invalid_argument for a channel that the source has not, a level that is not finite or a
  ///   hysteresis below zero.
  TriggeredCapture(const SourceDescription& source, const TriggerSettings& settings);

  /// Takes a block that a `GapLedger` has seen. Memory is taken only where a capture is handed over.
  void Take(const SampleBlock& block, const std::function<void(Capture)>& deliver);

  /// An event from outside, such as a fault: triggers at the next sample. `cause` in words.
  void Fire(std::string cause) { fired_ = std::move(cause); }

  /// Hands over a capture that still waits for samples behind its trigger, as far as it came; of an event
  /// that no sample has followed, what was before it.
  void Finish(const std::function<void(Capture)>& deliver);

  std::uint64_t ignored() const { return ignored_; }

  /// The memory that a sample of all channels takes.
  static std::size_t RowBytes(const SourceDescription& source) noexcept {
    return source.channels.size() * sizeof(std::uint32_t) + sizeof(Stamp);
  }

 private:
  // What the block's header says of one of its samples.
  struct Stamp {
    std::uint64_t number{};
    std::uint64_t device_counter{};
    std::uint64_t lost{};  // before it
    std::chrono::nanoseconds device_time{};
    std::chrono::nanoseconds arrival{};
    std::uint32_t flags{};
    bool begins{};  // the block
  };
  std::optional<std::string> CauseOf(double value) noexcept;
  void Keep(const SampleBlock& block, std::uint32_t sample) noexcept;
  Capture Unrolled() const;

  SourceDescription source_;
  TriggerSettings settings_;
  std::uint64_t most_rows_;
  std::vector<std::uint32_t> words_;  // a ring of frames
  std::vector<Stamp> stamps_;         // of each
  std::uint64_t kept_{};              // frames since the start
  std::optional<std::string> fired_;
  bool is_armed_;
  bool captures_{};
  std::string cause_;
  std::uint64_t trigger_sample_{};
  std::uint64_t trigger_frame_{};  // counted as `kept_` is
  std::optional<std::uint64_t> held_off_until_;
  std::uint64_t ignored_{};
};

}  // namespace strainwave::daq::acquisition
