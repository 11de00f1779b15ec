// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bench/prediction/signal_inputs.h"
#include "bench/prediction/window_sequence.h"
#include "bench/roles/vibration_source.h"

namespace strainwave::bench {

/// What one result is computed from.
struct VibrationWindow {
  std::int64_t begin_ns{};  // since 1970, UTC: of the first sample
  std::int64_t end_ns{};    // just after the last one
  double sample_rate_hz{};
  std::vector<std::string> channels;
  std::vector<std::vector<double>> samples;  // channels × samples
  std::optional<double> samples_per_turn{};  // of the input shaft, where its speed is known and steady
  std::string origin;
  std::optional<SignalFault> fault;  // found while cutting; the samples are then not to be used
};

struct WindowRule {
  enum class By { kTraining, kTrigger, kRevolution };
  By by{By::kTraining};
  WindowLength length{};          // by training: as the recipe has it; a measurement whole if it has none
  double sample_rate_hz{};        // at which all numbers of samples hold; 0: the stream's own
  std::string trigger_channel;    // a rising edge of it begins a window; empty: the source's own marks
  double trigger_level{};         // of the edge, in the channel's unit
  std::size_t trigger_samples{};  // of a window after an edge, at the least
  double turns{1.0};              // of the output shaft, by revolution
  double ratio{80.0};             // turns of the input shaft for one of the output's
  std::size_t most_samples{1u << 22};  // of any window: memory has a bound
};

/// Cuts a stream into windows. No sample is in two windows; a window that the stream breaks off comes out
/// with a fault, never shortened in silence. Windows that follow each other are cut as those of the training
/// (`WindowSequence`); what is left at the end of a measurement belongs to none.
class WindowCutter {
 public:
  explicit WindowCutter(WindowRule rule) : rule_(std::move(rule)) {}

  /// @return the windows that this chunk completes, in order of time.
  std::vector<VibrationWindow> Add(const VibrationChunk& chunk);

  /// Ends the stream: what is open cannot be completed.
  std::vector<VibrationWindow> Finish();

 private:
  bool Continues(const VibrationChunk& chunk) const;
  /// So many samples of the rule's rate in a stream that comes at a whole multiple of it.
  std::size_t SamplesAt(double rate_hz, std::size_t samples) const;
  void AddByMark(const VibrationChunk& chunk);
  void AddByEdge(const VibrationChunk& chunk, const std::vector<double>& trigger);
  void AddAsTrained(const VibrationChunk& chunk);
  void AddBySamples(const VibrationChunk& chunk);
  void AddByTurn(const VibrationChunk& chunk, double turns_a_window);
  /// The next sample of windows of one length that follow each other.
  /// @param from  of the chunk, what the open window has not taken yet.
  void AddInSequence(const VibrationChunk& chunk, std::size_t sample, double position, double length,
                     std::size_t& from);
  void AddRest(const VibrationChunk& chunk, std::size_t from);
  /// The open window if it is whole, though no other one has begun.
  void FinishSequence();
  void BeginMeasurement();
  /// Leaves what is open.
  void Restart();
  void BreakOff(const std::string& why);
  void Open(const VibrationChunk& chunk, std::size_t at);
  void Append(const VibrationChunk& chunk, std::size_t from, std::size_t to);
  /// @param count  of the first samples that are the window; all by default.
  void Close(std::size_t count = std::numeric_limits<std::size_t>::max());
  void CloseWith(SignalFault fault);
  /// A finding about the stream and not about a window; once until it is mended.
  void Tell(const VibrationChunk& chunk, SignalFault fault);

  WindowRule rule_;
  std::vector<VibrationWindow> done_;
  std::optional<VibrationWindow> open_;
  std::vector<double> open_turns_;  // of the output shaft, at each sample of the open window that has them
  bool told_{};
  bool above_{true};                        // an edge needs a sample below it first
  std::optional<WindowSequence> sequence_;  // of an unbroken segment
  std::optional<double> turned_;            // of its last sample
  double turned_from_{};                    // of its first one
  double counted_{};                        // samples
};

}  // namespace strainwave::bench
