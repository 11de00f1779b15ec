// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/roles/vibration_source.h"
#include "daq/acquisition/clock_model.h"
#include "daq/acquisition/gap_ledger.h"
#include "daq/acquisition/sample_source.h"

namespace strainwave::bench {

/// What a device does not say of its own samples.
struct AcquisitionStream {
  double ratio{80.0};                             // turns of the input shaft to one of the output
  std::optional<double> input_speed_rad_per_s{};  // where no channel tells it
  std::vector<std::pair<std::string, std::string>> renamed{};  // the source's name, the predictor's
  std::chrono::nanoseconds silent_after{std::chrono::seconds(3)};
  /// Times real time, of a file that is replayed; infinity: as fast as it can. Nothing for a device: its
  /// times are those at which its samples were here, UTC.
  std::optional<double> pace{};
  std::int64_t start_ns{};  // of a replayed file: time of its first sample, since 1970, UTC
};

/// A source of the acquisition as a stream of vibration: calibrated, every lost sample said in the chunk that
/// follows the loss, silence and a lost device as a chunk with trouble, once until samples come again.
///
/// The speed of the input shaft is that of a channel `input_speed_rpm` or `input_speed_rad_per_s`, or the one
/// given. A channel in m/s² whose name does not end so is called NAME_m_per_s2, as records have it.
class AcquisitionSource final : public VibrationSource {
 public:
  /// Starts the source. @throws as SampleSource::Start; std::invalid_argument for a new name of a channel
  /// that is not there.
  AcquisitionSource(std::unique_ptr<daq::acquisition::SampleSource> source, AcquisitionStream stream);
  ~AcquisitionSource() override;

  Got Next(std::chrono::milliseconds patience, VibrationChunk& chunk) override;
  std::int64_t NowNanoseconds() const override;

  /// As the predictor may call them.
  const std::vector<std::string>& channels() const { return channels_; }
  double sample_rate_hz() const { return description_.rate_hz; }
  const std::string& name() const { return description_.name; }

 private:
  Got Take(VibrationChunk& chunk);
  Got Silence(VibrationChunk& chunk);
  Got Tell(const std::string& trouble, VibrationChunk& chunk);
  std::int64_t TimeOf(const daq::acquisition::BlockHeader& header);
  void AddTurns(VibrationChunk& chunk);

  std::unique_ptr<daq::acquisition::SampleSource> source_;
  AcquisitionStream stream_;
  daq::acquisition::SourceDescription description_;
  std::vector<std::string> channels_;
  std::optional<std::size_t> speed_channel_;
  double speed_unit_rad_per_s_{1.0};
  daq::acquisition::SampleBlock block_;
  daq::acquisition::GapLedger ledger_;
  daq::acquisition::ClockModel clock_;
  std::chrono::steady_clock::time_point began_;
  std::chrono::steady_clock::time_point last_block_;
  bool told_{};            // that nothing comes
  double output_turns_{};  // at the next sample
  std::atomic<std::int64_t> last_ns_;
};

}  // namespace strainwave::bench
