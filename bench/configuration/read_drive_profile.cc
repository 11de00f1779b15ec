// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/read_drive_profile.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/configuration/bench_bounds.h"
#include "bench/configuration/device_file.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {

using protocols::OperationMode;
using protocols::canopen::BitSource;
using protocols::canopen::BrakeControl;
using protocols::canopen::DataType;
using protocols::canopen::DriveProfile;
using protocols::canopen::PdoEntry;
using protocols::canopen::PdoFlow;
using protocols::canopen::PdoSetting;
using protocols::canopen::ProfileObject;
using schedules::Bound;
using schedules::Dimension;
using schedules::FileKind;
using schedules::Presence;
using schedules::ReadContext;
using schedules::YamlMap;

namespace {

constexpr FileKind kProfileFile{"drive profile", "drive_profile: 1"};
constexpr std::int64_t kMost32 = std::numeric_limits<std::uint32_t>::max();
constexpr std::int64_t kMost16 = std::numeric_limits<std::uint16_t>::max();

template <typename Number>
Number Whole(YamlMap& map, std::string_view key, Number standard) {
  return static_cast<Number>(map.Integer(key, std::numeric_limits<Number>::min(),
                                         std::numeric_limits<Number>::max(), fmt::format("{}", standard)));
}

std::uint16_t Milliseconds(YamlMap& map, std::string_view key, std::uint16_t standard_ms) {
  const double time_s =
      map.Quantity(key, Dimension::kTime, Bound::kNotNegative, fmt::format("{} ms", standard_ms));
  const double time_ms = time_s * 1e3;
  if (time_ms > static_cast<double>(kMost16)) {
    map.AddError(key, fmt::format("{} is too long (expected at most {} ms)", key, kMost16));
    return standard_ms;
  }
  return static_cast<std::uint16_t>(time_ms + 0.5);
}

std::chrono::nanoseconds Time(YamlMap& map, std::string_view key, std::chrono::nanoseconds standard) {
  const double time_s =
      map.Quantity(key, Dimension::kTime, Bound::kPositive, fmt::format("{} us", standard.count() / 1000));
  return std::chrono::nanoseconds(static_cast<std::int64_t>(time_s * 1e9 + 0.5));
}

std::vector<OperationMode> ReadModes(YamlMap& map) {
  constexpr std::pair<std::string_view, OperationMode> kModes[] = {
      {"pp", OperationMode::kProfilePosition}, {"pv", OperationMode::kProfileVelocity},
      {"tq", OperationMode::kProfileTorque},   {"homing", OperationMode::kHoming},
      {"csp", OperationMode::kCyclicPosition}, {"csv", OperationMode::kCyclicVelocity},
      {"cst", OperationMode::kCyclicTorque}};
  std::vector<OperationMode> modes;
  for (const std::string& word : map.TextList("modes")) {
    const auto* known = std::find_if(std::begin(kModes), std::end(kModes),
                                     [&](const auto& mode) { return mode.first == word; });
    if (known == std::end(kModes)) {
      map.AddError("modes",
                   fmt::format("modes has {} (expected some of pp, pv, tq, homing, csp, csv and cst)", word));
    } else {
      modes.push_back(known->second);
    }
  }
  return modes;
}

BitSource ReadBit(YamlMap map) {
  BitSource source;
  source.from = map.Choice<BitSource::From>("from",
                                            {{"nowhere", BitSource::From::kNowhere},
                                             {"statusword", BitSource::From::kStatusword},
                                             {"digital_inputs", BitSource::From::kDigitalInputs}},
                                            "nowhere");
  source.mask = static_cast<std::uint32_t>(map.Integer("mask", 0, kMost32, "0"));
  source.is_low_active = map.Flag("low_active", "false");
  map.Finish();
  return source;
}

BrakeControl ReadBrake(YamlMap map) {
  BrakeControl brake;
  brake.by = map.Choice<BrakeControl::By>("by",
                                          {{"drive", BrakeControl::By::kDrive},
                                           {"controlword", BrakeControl::By::kControlword},
                                           {"digital_output", BrakeControl::By::kDigitalOutput}},
                                          "drive");
  brake.mask = static_cast<std::uint32_t>(map.Integer("mask", 0, kMost32, "0"));
  brake.engages_when_high = map.Flag("engages_when_high", "false");
  brake.waits_for_standstill = map.Flag("waits_for_standstill", "false");
  brake.engaged_feedback = ReadBit(map.Map("engaged_feedback", Presence::kOptional));
  map.Finish();
  return brake;
}

std::vector<ProfileObject> ReadObjects(std::vector<YamlMap> maps) {
  std::vector<ProfileObject> objects;
  for (YamlMap& map : maps) {
    ProfileObject object;
    object.address.index = static_cast<std::uint16_t>(map.Integer("index", 0x1000, kMost16));
    object.address.subindex = static_cast<std::uint8_t>(map.Integer("subindex", 0, 255, "0"));
    object.type = map.Choice<DataType>("type", {{"integer8", DataType::kInteger8},
                                                {"integer16", DataType::kInteger16},
                                                {"integer32", DataType::kInteger32},
                                                {"unsigned8", DataType::kUnsigned8},
                                                {"unsigned16", DataType::kUnsigned16},
                                                {"unsigned32", DataType::kUnsigned32}});
    object.value = map.Integer("value", std::numeric_limits<std::int32_t>::min(), kMost32);
    object.action =
        map.Choice<ProfileObject::Action>("action",
                                          {{"write", ProfileObject::Action::kWrite},
                                           {"write_and_read_back", ProfileObject::Action::kWriteAndReadBack},
                                           {"expect", ProfileObject::Action::kExpect}},
                                          "write_and_read_back");
    object.purpose = map.Text("purpose", "");
    map.Finish();
    objects.push_back(std::move(object));
  }
  return objects;
}

// "0x6040:0:16", index, sub-index and bits.
std::optional<PdoEntry> EntryOf(std::string_view text) {
  std::uint32_t numbers[3]{};
  for (std::uint32_t& number : numbers) {
    const bool is_hex = text.starts_with("0x");
    if (is_hex) text.remove_prefix(2);
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), number, is_hex ? 16 : 10);
    if (error != std::errc()) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    const bool last = &number == &numbers[2];
    if (last != text.empty() || (!last && text.front() != ':')) return std::nullopt;
    if (!last) text.remove_prefix(1);
  }
  if (numbers[0] > kMost16 || numbers[1] > 255 || numbers[2] < 1 || numbers[2] > 64) return std::nullopt;
  return PdoEntry{{static_cast<std::uint16_t>(numbers[0]), static_cast<std::uint8_t>(numbers[1])},
                  static_cast<std::uint8_t>(numbers[2])};
}

std::vector<PdoSetting> ReadPdos(std::vector<YamlMap> maps) {
  std::vector<PdoSetting> pdos;
  for (YamlMap& map : maps) {
    PdoSetting pdo;
    pdo.flow =
        map.Choice<PdoFlow>("flow", {{"to_drive", PdoFlow::kToDrive}, {"from_drive", PdoFlow::kFromDrive}});
    pdo.number = static_cast<std::uint16_t>(map.Integer("number", 1, 512));
    pdo.cob_id = static_cast<std::uint32_t>(map.Integer("cob_id", 0x180, 0x57F));
    pdo.transmission_type = static_cast<std::uint8_t>(map.Integer("transmission", 0, 255));
    if (map.has("inhibit_time_100us")) {
      pdo.inhibit_time_100us = static_cast<std::uint16_t>(map.Integer("inhibit_time_100us", 0, kMost16));
    }
    if (map.has("event_timer")) pdo.event_timer_ms = Milliseconds(map, "event_timer", 0);
    for (const std::string& text : map.TextList("map")) {
      if (const auto entry = EntryOf(text)) {
        pdo.entries.push_back(*entry);
      } else {
        map.AddError("map",
                     fmt::format("map has {} (expected INDEX:SUBINDEX:BITS, as in 0x6040:0:16)", text));
      }
    }
    map.Finish();
    pdos.push_back(std::move(pdo));
  }
  return pdos;
}

void ReadUnits(YamlMap map, protocols::canopen::DriveUnits& units) {
  units.position_counts_per_rev = map.Number("counts_per_rev", Bound::kPositive);
  units.velocity_units_per_rpm = map.Number("velocity_units_per_rpm", Bound::kPositive, "1");
  units.acceleration_units_per_rpm_per_s =
      map.Number("acceleration_units_per_rpm_per_s", Bound::kPositive, "1");
  units.rated_torque_Nm = map.Quantity("rated_torque", Dimension::kTorque, Bound::kPositive);
  units.rated_torque_units_per_Nm = map.Choice<double>(
      "rated_torque_unit", {{"Nm", 1.0}, {"Ncm", 100.0}, {"mNm", 1e3}, {"uNm", 1e6}}, "mNm");
  map.Finish();
}

void ReadLimits(YamlMap map, protocols::canopen::DriveLimits& limits) {
  limits.max_speed_rad_per_s = map.Quantity("speed", Dimension::kAngularSpeed, Bound::kPositive);
  limits.max_torque_Nm = map.Quantity("torque", Dimension::kTorque, Bound::kPositive);
  limits.acceleration_rad_per_s2 =
      map.Quantity("acceleration", Dimension::kAngularAcceleration, Bound::kPositive);
  limits.quick_stop_deceleration_rad_per_s2 =
      map.Quantity("quick_stop_deceleration", Dimension::kAngularAcceleration, Bound::kPositive);
  limits.following_error_window_rad =
      map.Quantity("following_error_window", Dimension::kAngle, Bound::kPositive);
  limits.following_error_time_ms = Milliseconds(map, "following_error_time", 0);
  limits.standstill_speed_rad_per_s =
      map.Quantity("standstill_speed", Dimension::kAngularSpeed, Bound::kPositive, "5 rpm");
  map.Finish();
}

void ReadSupervision(YamlMap map, protocols::canopen::Supervision& supervision) {
  supervision.master_node_id = static_cast<std::uint8_t>(map.Integer("master_node", 1, 127, "127"));
  supervision.drive_heartbeat_ms = Milliseconds(map, "drive_heartbeat", supervision.drive_heartbeat_ms);
  supervision.drive_timeout_ms = Milliseconds(map, "drive_timeout", supervision.drive_timeout_ms);
  supervision.master_heartbeat_ms = Milliseconds(map, "master_heartbeat", supervision.master_heartbeat_ms);
  supervision.master_timeout_ms = Milliseconds(map, "master_timeout", supervision.master_timeout_ms);
  supervision.communication_error_behaviour =
      Whole(map, "communication_error_behaviour", supervision.communication_error_behaviour);
  supervision.rpdo_event_timer_ms = Milliseconds(map, "rpdo_event_timer", supervision.rpdo_event_timer_ms);
  map.Finish();
}

void ReadOptionCodes(YamlMap map, protocols::canopen::OptionCodes& codes) {
  codes.abort_connection = Whole(map, "abort_connection", codes.abort_connection);
  codes.quick_stop = Whole(map, "quick_stop", codes.quick_stop);
  codes.shutdown = Whole(map, "shutdown", codes.shutdown);
  codes.disable_operation = Whole(map, "disable_operation", codes.disable_operation);
  codes.halt = Whole(map, "halt", codes.halt);
  codes.fault_reaction = Whole(map, "fault_reaction", codes.fault_reaction);
  map.Finish();
}

void ReadTiming(YamlMap map, protocols::canopen::DriveTiming& timing) {
  timing.sync_period = Time(map, "sync_period", timing.sync_period);
  timing.most_sync_deviation = Time(map, "most_sync_deviation", timing.most_sync_deviation);
  const double lag_s =
      map.OptionalQuantity("position_loop_lag", Dimension::kTime, Bound::kPositive).value_or(0.0);
  timing.position_loop_lag = std::chrono::nanoseconds(static_cast<std::int64_t>(lag_s * 1e9 + 0.5));
  timing.stale_after_syncs = static_cast<unsigned>(map.Integer("stale_after_syncs", 1, 1000, "5"));
  const double stale_s = timing.stale_after_syncs * std::chrono::duration<double>(timing.sync_period).count();
  if (stale_s > kLongestUnwatched_s) {
    map.AddError(
        "stale_after_syncs",
        fmt::format("stale_after_syncs = {} of the sync_period are {:g} s (expected at most {:g} s, since "
                    "the shafts turn unwatched meanwhile)",
                    timing.stale_after_syncs, stale_s, kLongestUnwatched_s));
  }
  timing.sdo_timeout = Time(map, "sdo_timeout", timing.sdo_timeout);
  timing.start_timeout = Time(map, "start_timeout", timing.start_timeout);
  timing.stage_timeout = Time(map, "stage_timeout", timing.stage_timeout);
  timing.mode_timeout = Time(map, "mode_timeout", timing.mode_timeout);
  timing.stop_timeout = Time(map, "stop_timeout", timing.stop_timeout);
  timing.reset_hold = Time(map, "reset_hold", timing.reset_hold);
  map.Finish();
}

std::vector<std::uint16_t> Numbers16(YamlMap& map, std::string_view key) {
  std::vector<std::uint16_t> numbers;
  for (const std::string& text : map.TextList(key)) {
    const auto number = protocols::canopen::EdsNumber(text, 0);
    if (number && *number >= 0 && *number <= kMost16) {
      numbers.push_back(static_cast<std::uint16_t>(*number));
    } else {
      map.AddError(key, fmt::format("{} has {} (expected numbers from 0 to 0xFFFF)", key, text));
    }
  }
  return numbers;
}

void ReadQuirks(YamlMap map, protocols::canopen::DriveQuirks& quirks) {
  quirks.absent_objects = Numbers16(map, "absent_objects");
  quirks.warning_codes = Numbers16(map, "warning_codes");
  quirks.lacks_rpdo_event_timer = map.Flag("lacks_rpdo_event_timer", "false");
  quirks.lacks_tpdo_event_timer = map.Flag("lacks_tpdo_event_timer", "false");
  map.Finish();
}

void CheckAgainstEds(DriveProfile& profile, const std::string& eds_file, const std::filesystem::path& folder,
                     ReadContext& context) {
  // Any node serves: what depends on its number is shifted by it alike on both sides.
  constexpr std::uint8_t kSomeNode = 1;
  const schedules::Origin& place = context.origins["eds"];
  const auto error = [&](const std::string& message) {
    context.findings.AddError(place.line, place.column, message);
  };
  const std::filesystem::path path = folder / eds_file;
  schedules::FindingList findings;
  const auto text = schedules::ReadInputFile(path, {"electronic data sheet", "[FileInfo]"}, findings);
  if (!text) {
    return error(
        fmt::format("eds = {} cannot be read (expected the drive's EDS file beside this one)", eds_file));
  }
  try {
    const auto eds = protocols::canopen::ParseEds(*text, path.string());
    for (const auto& finding : protocols::canopen::CheckProfileAgainstEds(profile, eds, kSomeNode)) {
      error(fmt::format("{}:{}:{}: {}", path.string(), finding.line, finding.column, finding.what));
    }
    profile.eds_notes = eds.notes;
  } catch (const std::runtime_error& failure) {
    error(fmt::format("eds = {} cannot be used (expected an EDS file):\n{}", eds_file, failure.what()));
  }
}

DriveProfile ReadDriveDevice(const schedules::YamlNode& root, const std::filesystem::path& folder,
                             ReadContext& context) {
  context.bounds = DeviceBounds();
  YamlMap map(root, context);
  map.Version("drive_profile");
  DriveProfile profile;
  profile.name = map.Text("name");
  YamlMap identity = map.Map("identity", Presence::kOptional);
  profile.identity.vendor = static_cast<std::uint32_t>(identity.Integer("vendor", 0, kMost32, "0"));
  profile.identity.product = static_cast<std::uint32_t>(identity.Integer("product", 0, kMost32, "0"));
  profile.identity.revision = static_cast<std::uint32_t>(identity.Integer("revision", 0, kMost32, "0"));
  identity.Finish();
  profile.modes = ReadModes(map);
  ReadUnits(map.Map("units", Presence::kRequired), profile.units);
  ReadLimits(map.Map("limits", Presence::kRequired), profile.limits);
  ReadSupervision(map.Map("supervision", Presence::kOptional), profile.supervision);
  ReadOptionCodes(map.Map("option_codes", Presence::kOptional), profile.option_codes);
  profile.brake = ReadBrake(map.Map("brake", Presence::kOptional));
  profile.safe_torque_off = ReadBit(map.Map("safe_torque_off", Presence::kOptional));
  profile.objects = ReadObjects(map.MapList("objects", Presence::kOptional));
  profile.pdos = ReadPdos(map.MapList("pdos", Presence::kOptional));
  ReadTiming(map.Map("timing", Presence::kOptional), profile.timing);
  ReadQuirks(map.Map("quirks", Presence::kOptional), profile.quirks);
  const std::string eds = map.Text("eds", "");
  map.Finish();
  if (context.findings.has_errors()) return profile;
  const std::vector<std::string> wrong = protocols::canopen::CheckProfile(profile);
  for (const std::string& finding : wrong) context.findings.AddError(root.line, root.column, finding);
  if (wrong.empty() && !eds.empty()) CheckAgainstEds(profile, eds, folder, context);
  return profile;
}

}  // namespace

DriveProfile ReadDriveProfile(const std::filesystem::path& path) {
  return ParseDriveProfile(TextOfFile<BenchFileError>(path, kProfileFile), path.string(), path.parent_path());
}

DriveProfile ParseDriveProfile(const std::string& text, std::string_view file_name,
                               const std::filesystem::path& folder) {
  return ParseFile<BenchFileError>(text, file_name, kProfileFile,
                                   [&](const schedules::YamlNode& root, ReadContext& context) {
                                     return ReadDriveDevice(root, folder, context);
                                   });
}

DriveProfile AtAxis(DriveProfile profile, double gear_ratio, int sign) {
  profile.units.gear_ratio = gear_ratio;
  profile.units.sign = sign;
  profile.limits.max_speed_rad_per_s /= gear_ratio;
  profile.limits.max_torque_Nm *= gear_ratio;
  profile.limits.acceleration_rad_per_s2 /= gear_ratio;
  profile.limits.quick_stop_deceleration_rad_per_s2 /= gear_ratio;
  profile.limits.following_error_window_rad /= gear_ratio;
  profile.limits.standstill_speed_rad_per_s /= gear_ratio;
  return profile;
}

}  // namespace strainwave::bench
