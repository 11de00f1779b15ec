// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "bench/devices/latest.h"
#include "bench/devices/monotonic_clock.h"
#include "daq/acquisition/decimator.h"
#include "daq/acquisition/gap_ledger.h"
#include "daq/acquisition/sample_source.h"
#include "daq/acquisition/sensor_watch.h"
#include "daq/acquisition/spsc_ring.h"

namespace strainwave::bench {

/// The newest sample of every channel of a source.
struct SourceSnapshot {
  static constexpr std::size_t kMostChannels = 32;

  std::chrono::nanoseconds time{};  // of arrival, on the bench's clock; zero before the first block
  std::array<double, kMostChannels> values{};  // calibrated, in the channel's unit
  std::uint32_t bad_channels{~0U};             // bit n: channel n is not to be trusted
  /// Over the last whole tenth of a second, about its mean, of the strongest channel in m/s².
  double vibration_rms_m_per_s2{};
};

/// A source of samples on a thread of its own: the newest values for a control loop, all samples for a
/// measurement that asks for them, and what was lost or looked wrong.
class SourceReader {
 public:
  /// Starts the source. @throws std::system_error as SampleSource::Start does; std::invalid_argument for a
  /// source of more than `SourceSnapshot::kMostChannels` channels.
  SourceReader(std::unique_ptr<daq::acquisition::SampleSource> source, const MonotonicClock& clock);
  SourceReader(const SourceReader&) = delete;
  SourceReader& operator=(const SourceReader&) = delete;
  ~SourceReader();

  const daq::acquisition::SourceDescription& description() const noexcept { return description_; }
  /// The number of a channel, or nothing.
  std::optional<std::size_t> Find(std::string_view channel) const;

  // From any thread.
  SourceSnapshot Newest() const noexcept { return newest_.Get(); }
  daq::acquisition::GapTotals totals() const noexcept { return totals_.Get(); }
  /// What is wrong at the moment, channel by channel or with the source itself, in words; empty if nothing.
  std::string Trouble() const;

  // Capturing, from one thread: all samples of some channels, from the next block on.
  /// @throws std::invalid_argument if the source's rate is not a whole multiple of `rate_hz`.
  void StartCapture(std::span<const std::size_t> channels, double rate_hz);
  void StopCapture();
  /// Appends what came in since the last call, calibrated, one vector a channel in the order of StartCapture.
  void Drain(std::span<std::vector<float>* const> channels);
  /// Samples that are missing in the capture so far.
  std::uint64_t lost_in_capture() const noexcept;

 private:
  struct Capture;

  void Run();
  void Take(daq::acquisition::SampleBlock& block);
  void MeasureVibration(const daq::acquisition::SampleBlock& block) noexcept;
  void Keep(const daq::acquisition::SampleBlock& block);
  void Say(std::string trouble);

  std::unique_ptr<daq::acquisition::SampleSource> source_;
  const MonotonicClock& clock_;
  daq::acquisition::SourceDescription description_;

  // Of the reader's thread.
  daq::acquisition::GapLedger ledger_;
  daq::acquisition::SensorWatch watch_;
  SourceSnapshot next_;
  std::vector<std::size_t> accelerometers_;
  std::vector<double> sums_;
  std::vector<double> squares_;
  std::size_t in_window_{};
  std::size_t window_{};

  Latest<SourceSnapshot> newest_;
  Latest<daq::acquisition::GapTotals> totals_;
  mutable std::mutex mutex_;  // of the two below; held for moments only
  std::string trouble_;
  std::shared_ptr<Capture> capture_;  // shared for the moment in which one is exchanged
  std::shared_ptr<Capture> drained_;  // of the capturing thread
  std::atomic<bool> ending_{};
  std::thread thread_;
};

}  // namespace strainwave::bench
