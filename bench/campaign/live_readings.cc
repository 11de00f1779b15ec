// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/live_readings.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <system_error>
#include <type_traits>

#include <fmt/core.h>

#include "analysis/units.h"
#include "bench/configuration/sensors_of.h"
#include "daq/data_file_error.h"

namespace strainwave::bench {
namespace {

// As it lies in the file; native byte order, since it is read on the machine that writes it.
struct Shown {
  std::int32_t version;
  std::uint32_t bad_channels;
  std::int64_t utc_ms;
  std::int64_t since_boot_ms;
  std::uint64_t boot;
  double output_torque_Nm;
  double input_speed_rad_per_s;
  double gear_temperature_degC;
  double vibration_rms_m_per_s2;
};
static_assert(std::is_trivially_copyable_v<Shown>);
constexpr std::int32_t kReadingsVersion = 1;
constexpr std::int64_t kInterval_ms = 500;

}  // namespace

LiveReadingsFile::LiveReadingsFile(const std::filesystem::path& path) : path_(path) {
  std::error_code none;
  std::filesystem::remove(path_, none);  // of a run that was killed
  try {
    file_.emplace(path_);
  } catch (const daq::DataFileError&) {
    // A campaign does not end because nobody can look on.
  }
}

LiveReadingsFile::~LiveReadingsFile() {
  std::error_code none;
  std::filesystem::remove(path_, none);
}

void LiveReadingsFile::Show(const Readings& readings) noexcept {
  const Moment now = Now();
  if (!file_ || now.since_boot_ms - last_.since_boot_ms < kInterval_ms) return;
  last_ = now;
  const Shown shown{kReadingsVersion,
                    readings.bad_channels,
                    now.utc_ms,
                    now.since_boot_ms,
                    now.boot,
                    readings.output_torque_Nm,
                    readings.input_speed_rad_per_s,
                    readings.gear_temperature_degC,
                    readings.vibration_rms_m_per_s2};
  try {
    file_->Write(std::as_bytes(std::span(&shown, 1)));
  } catch (const daq::DataFileError&) {
    file_.reset();
  }
}

std::optional<LiveReadings> ReadLiveReadings(const std::filesystem::path& path) {
  Shown shown{};
  try {
    const auto newest = daq::ReadCheckpoint(path);
    if (!newest || newest->payload.size() != sizeof shown) return std::nullopt;
    std::memcpy(&shown, newest->payload.data(), sizeof shown);
  } catch (const daq::DataFileError&) {
    return std::nullopt;
  }
  if (shown.version != kReadingsVersion) return std::nullopt;
  return LiveReadings{{shown.utc_ms, shown.since_boot_ms, shown.boot},
                      shown.output_torque_Nm,
                      shown.input_speed_rad_per_s,
                      shown.gear_temperature_degC,
                      shown.vibration_rms_m_per_s2,
                      shown.bad_channels};
}

std::vector<LiveValue> LiveValues(const LiveReadings& readings, const std::optional<double>& age_s,
                                  const schedules::Limits& limits, const BenchDescription& bench) {
  std::vector<LiveValue> values;
  const std::array shown{readings.output_torque_Nm, readings.input_speed_rad_per_s,
                         readings.gear_temperature_degC, readings.vibration_rms_m_per_s2};
  const std::array limit{limits.output_torque_Nm, limits.input_speed_rad_per_s, limits.gear_temperature_degC,
                         limits.vibration_rms_m_per_s2};
  for (std::size_t i = 0; i < kLiveQuantities.size(); ++i) {
    const LiveQuantity& quantity = kLiveQuantities[i];
    LiveValue live{std::string(quantity.name), std::nullopt, limit[i] * quantity.per_si,
                   std::string(quantity.unit)};
    if (quantity.channel == Channel::kVibrationRms && !SensorsOf(bench).vibration) {
      live.missing = "the bench has no accelerometers";
    } else if (!age_s || *age_s > kOldestLive_s) {
      live.missing = "stale";
    } else if ((readings.bad_channels & (1u << static_cast<unsigned>(quantity.channel))) != 0) {
      live.missing = "the channel is bad";
    } else {
      live.value = shown[i] * quantity.per_si;
    }
    values.push_back(std::move(live));
  }
  return values;
}

}  // namespace strainwave::bench
