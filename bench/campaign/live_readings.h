// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/units.h"
#include "bench/campaign/pause.h"
#include "bench/configuration/bench_description.h"
#include "bench/controller/live_extremes.h"
#include "bench/roles/sampler.h"
#include "daq/checkpoint_file.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// The newest readings of a campaign that runs, as another process sees them.
struct LiveReadings {
  Moment taken{};
  double output_torque_Nm{};
  double input_speed_rad_per_s{};
  double gear_temperature_degC{};
  double vibration_rms_m_per_s2{};
  unsigned bad_channels{};  // as in Readings
};

/// Shows the readings to other processes, in a file that is there while this object lives. A write is one
/// system call in place: it waits for no disk and needs no room on one.
class LiveReadingsFile {
 public:
  explicit LiveReadingsFile(const std::filesystem::path& path);
  LiveReadingsFile(const LiveReadingsFile&) = delete;
  LiveReadingsFile& operator=(const LiveReadingsFile&) = delete;
  ~LiveReadingsFile();

  /// Twice a second of the world's at most; what comes in between is let go.
  void Show(const Readings& readings) noexcept;

 private:
  std::filesystem::path path_;
  std::optional<daq::CheckpointFile> file_;  // none: it cannot be made or written, and nobody sees anything
  Moment last_{};
};

/// What a running process shows; nothing where it shows nothing (yet).
std::optional<LiveReadings> ReadLiveReadings(const std::filesystem::path& path);

/// How a live channel is shown, in the order of `kLiveChannels`.
struct LiveQuantity {
  Channel channel;
  std::string_view name;
  std::string_view unit;
  double per_si;  // of the unit, in one of `Readings`
};
inline constexpr std::array<LiveQuantity, kLiveChannels.size()> kLiveQuantities{
    {{Channel::kOutputTorque, "output torque", "Nm", 1.0},
     {Channel::kInputSpeed, "input speed", "rpm", RpmFromRadPerS(1.0)},
     {Channel::kGearTemperature, "gear temperature", "degC", 1.0},
     {Channel::kVibrationRms, "vibration RMS", "m/s2", 1.0}}};

/// A reading beside the limit that stops the bench, in the units of a schedule.
struct LiveValue {
  std::string quantity;         // "output torque"
  std::optional<double> value;  // nothing: see `missing`
  double limit{};
  std::string unit;
  std::string missing{};  // why there is no value
};

/// Readings of a process that is held up, or of a bench that nobody has read since, are no values any more.
inline constexpr double kOldestLive_s = 5.0;

/// @param age_s  of the readings; nothing: not known.
std::vector<LiveValue> LiveValues(const LiveReadings& readings, const std::optional<double>& age_s,
                                  const schedules::Limits& limits, const BenchDescription& bench);

}  // namespace strainwave::bench
