// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "bench/devices/monotonic_clock.h"
#include "bench/realtime/latest.h"
#include "bench/realtime/realtime_mutex.h"
#include "daq/acquisition/clock_model.h"
#include "daq/acquisition/decimator.h"
#include "daq/acquisition/gap_ledger.h"
#include "daq/acquisition/sample_source.h"
#include "daq/acquisition/sensor_watch.h"
#include "daq/acquisition/spsc_ring.h"
#include "daq/acquisition/stream_recorder.h"
#include "daq/acquisition/trigger.h"
#include "daq/acquisition/turn_counter.h"

namespace strainwave::bench {

/// The newest sample of every channel of a source.
struct SourceSnapshot {
  static constexpr std::size_t kMostChannels = 32;

  std::chrono::nanoseconds time{};  // of arrival, on the bench's clock; zero before the first block
  /// When it was taken, on the same clock, as far as the device's clock is known; else that of arrival.
  std::chrono::nanoseconds sampled{};
  std::array<double, kMostChannels> values{};  // calibrated, in the channel's unit
  std::uint32_t bad_channels{~0U};             // bit n: channel n is not to be trusted
  double block_s{};                            // that the newest block lasts
  /// Over the last whole tenth of a second, about its mean, of the strongest channel in m/s²; a NaN before.
  double vibration_rms_m_per_s2{std::numeric_limits<double>::quiet_NaN()};
};

/// What a source has come to since it was connected.
struct ReaderState {
  daq::acquisition::GapTotals totals;
  std::optional<daq::acquisition::ClockEstimate> clock;  // nothing: not known yet
  std::uint64_t clock_restarts{};
};

/// A source of samples on a thread of its own: the newest values for a control loop, all samples for a
/// measurement that asks for them, and what was lost or looked wrong.
class SourceReader {
 public:
  /// Starts the source.
  /// @param calibrations  by the channel's name at the source, in place of what the source itself says.
  /// @throws std::system_error as SampleSource::Start does; std::invalid_argument for a
  /// source of more than `SourceSnapshot::kMostChannels` channels.
  SourceReader(std::unique_ptr<daq::acquisition::SampleSource> source, const MonotonicClock& clock,
               const std::map<std::string, daq::acquisition::Calibration>& calibrations = {});
  SourceReader(const SourceReader&) = delete;
  SourceReader& operator=(const SourceReader&) = delete;
  ~SourceReader();

  const daq::acquisition::SourceDescription& description() const noexcept { return description_; }
  /// The number of a channel, or nothing.
  std::optional<std::size_t> Find(std::string_view channel) const;

  // From any thread.
  /// After `GoOnFrom` that of the first block since.
  SourceSnapshot Newest() const noexcept;
  daq::acquisition::GapTotals totals() const noexcept { return state_.Get().totals; }
  /// The device's clock against the monotonic one, once it is known, and how often it was set anew.
  std::optional<daq::acquisition::ClockEstimate> clock() const noexcept { return state_.Get().clock; }
  std::uint64_t clock_restarts() const noexcept { return state_.Get().clock_restarts; }
  /// What its encoders have been counted to over the ends of their 32 bits, one number each.
  std::vector<std::int64_t> Turns() const;
  /// From the next block on they go on from there, where they were before the power went. Of another number
  /// of encoders nothing is taken.
  void GoOnFrom(std::span<const std::int64_t> turns);
  /// What is wrong at the moment, channel by channel or with the source itself, in words; empty if nothing.
  std::string Trouble() const;
  /// The same of one channel and of the source itself; empty if nothing.
  std::string TroubleOf(std::size_t channel) const;

  // Capturing, from one thread: all samples of some channels, from the next block on.
  /// @throws std::invalid_argument if the source's rate is not a whole multiple of `rate_hz`.
  void StartCapture(std::span<const std::size_t> channels, double rate_hz);
  void StopCapture();
  /// Appends what came in since the last call, calibrated, one vector a channel in the order of StartCapture.
  void Drain(std::span<std::vector<float>* const> channels);
  /// Keeps every block as it comes, from the next one on. @throws as StreamRecorder does.
  void StartRecording(const daq::acquisition::RecorderSettings& settings);
  struct Recorded {
    daq::acquisition::RecorderTotals totals;
    std::string trouble;  // why writing ended early
  };
  /// Ends it and finishes the file; nothing where nothing is recorded.
  std::optional<Recorded> StopRecording();

  /// The bench has tripped: what the source sends about now is kept, ten seconds before and ten after where
  /// that fits into 128 MB. Of several trips the first counts, until it is taken. Not for the cyclic path.
  void MarkTrip();
  /// What was around the trip, once it has come; nothing where none was marked or nothing ever came. Waits.
  std::optional<daq::acquisition::Capture> TakeAroundTrip();

  /// Samples that are missing in the capture so far.
  std::uint64_t lost_in_capture() const noexcept;

 private:
  struct Capture;

  void Run();
  void Record(const daq::acquisition::SampleBlock& block);
  void Take(daq::acquisition::SampleBlock& block);
  std::chrono::nanoseconds FollowClock(const daq::acquisition::SampleBlock& block) noexcept;
  void Publish() noexcept;
  void CountTurns(const daq::acquisition::SampleBlock& block);
  void MeasureVibration(const daq::acquisition::SampleBlock& block) noexcept;
  void Keep(const daq::acquisition::SampleBlock& block);
  void Say(const std::string& trouble);
  static daq::acquisition::TriggerSettings AroundTrip(const daq::acquisition::SourceDescription& source);
  void FinishAroundTrip();
  void Deliver(daq::acquisition::Capture around);

  std::unique_ptr<daq::acquisition::SampleSource> source_;
  const MonotonicClock& clock_;
  daq::acquisition::SourceDescription description_;

  // Of the reader's thread.
  daq::acquisition::GapLedger ledger_;
  daq::acquisition::SensorWatch watch_;
  daq::acquisition::ClockModel device_clock_;
  SourceSnapshot next_;
  std::vector<std::size_t> accelerometers_;
  std::vector<double> sums_;
  std::vector<double> squares_;
  std::size_t in_window_{};
  std::size_t window_{};
  daq::acquisition::TriggeredCapture around_trip_;
  std::optional<std::chrono::nanoseconds> tripped_;  // seen then

  Latest<SourceSnapshot> newest_;
  std::atomic<std::int64_t> since_ns_{};  // older ones are counted from elsewhere
  Latest<ReaderState> state_;
  mutable RealtimeMutex mutex_;                                 // of those below; held for moments only
  std::map<std::size_t, daq::acquisition::TurnCounter> turns_;  // of the channels that go over
  std::unique_ptr<daq::acquisition::StreamRecorder> recorder_;
  std::string trouble_;               // of the source itself
  std::vector<std::string> reasons_;  // channel by channel
  enum class Trip { kNone, kMarked, kSeen };
  Trip trip_{};
  std::optional<daq::acquisition::Capture> delivered_;
  std::condition_variable_any delivery_;
  std::shared_ptr<Capture> capture_;  // shared for the moment in which one is exchanged
  std::shared_ptr<Capture> drained_;  // of the capturing thread
  std::atomic<bool> ending_{};
  std::thread thread_;
};

}  // namespace strainwave::bench
