// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/settings.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/configuration/device_file.h"
#include "bench/serving/addresses.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {
namespace {

using schedules::Bound;
using schedules::Dimension;
using schedules::FileKind;
using schedules::Presence;
using schedules::ReadContext;
using schedules::YamlMap;
using schedules::YamlNode;

constexpr FileKind kKind{"monitor settings", "monitor: 1"};
constexpr int kMostWindows = 10'000'000;
constexpr int kMostMebibytes = 65'536;
constexpr int kMostConnections = 500;  // of a process that may have 1024 files open
// What a certificate file may hold at most: the authorities that a system trusts take 220 KiB.
constexpr std::uintmax_t kMostCertificates_KiB = 1024;
constexpr std::uintmax_t kMostPassword_KiB = 64;

std::int64_t Milliseconds(double time_s) { return std::llround(time_s * 1e3); }

// Empty where the key is left out.
std::string OptionalIdentifier(YamlMap& map, std::string_view key) {
  return map.has(key) ? map.Identifier(key) : map.Text(key, "");
}

WindowRule ReadWindows(YamlMap map) {
  using By = WindowRule::By;
  WindowRule rule;
  const bool by_edge = map.has("trigger_channel");
  rule.by = map.Choice<By>(
      "by", {{"training", By::kTraining}, {"trigger", By::kTrigger}, {"revolution", By::kRevolution}},
      by_edge ? "trigger" : "training");
  rule.trigger_channel = OptionalIdentifier(map, "trigger_channel");
  rule.trigger_level =
      by_edge ? map.Number("trigger_level", Bound::kAny) : map.Number("trigger_level", Bound::kAny, "0");
  rule.turns = map.Number("turns", Bound::kPositive, "1");
  if (rule.by != By::kTrigger && by_edge) {
    map.AddError("trigger_channel",
                 fmt::format("trigger_channel has no meaning for windows by {} (expected 'by: trigger')",
                             rule.by == By::kRevolution ? "revolution" : "training"));
  }
  map.Finish();
  return rule;
}

std::optional<double> OptionalNumber(YamlMap& map, std::string_view key) {
  if (!map.has(key)) return std::nullopt;
  return map.Number(key, Bound::kAny);
}

// The alarm lies beyond the warning, and what is too high lies above what is too low.
void CheckOrder(YamlMap& map, const AlarmLimits& limits) {
  if (limits.alarm_above && limits.warning_above && *limits.alarm_above < *limits.warning_above) {
    map.AddError(
        "alarm_above",
        fmt::format("alarm_above = {} is below warning_above = {} (expected the alarm beyond the warning)",
                    *limits.alarm_above, *limits.warning_above));
  }
  if (limits.alarm_below && limits.warning_below && *limits.alarm_below > *limits.warning_below) {
    map.AddError(
        "alarm_below",
        fmt::format("alarm_below = {} is above warning_below = {} (expected the alarm beyond the warning)",
                    *limits.alarm_below, *limits.warning_below));
  }
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  for (const auto& limit : {limits.warning_below, limits.alarm_below})
    low = std::max(low, limit.value_or(low));
  for (const auto& limit : {limits.warning_above, limits.alarm_above})
    high = std::min(high, limit.value_or(high));
  if (high - low < 2.0 * limits.hysteresis) {
    const std::string_view at = map.has("hysteresis") ? "hysteresis" : "output";
    map.AddError(
        at,
        fmt::format("nothing is left between {} and {} (expected lower and upper limits further apart than "
                    "twice the hysteresis)",
                    low, high));
  }
}

AlarmLimits ReadLimits(YamlMap& map) {
  AlarmLimits limits;
  limits.warning_above = OptionalNumber(map, "warning_above");
  limits.warning_below = OptionalNumber(map, "warning_below");
  limits.alarm_above = OptionalNumber(map, "alarm_above");
  limits.alarm_below = OptionalNumber(map, "alarm_below");
  limits.hysteresis = map.Number("hysteresis", Bound::kNotNegative, "0");
  limits.hold_ms = Milliseconds(map.Quantity("hold", Dimension::kTime, Bound::kNotNegative, "0 s"));
  const bool any = limits.warning_above || limits.warning_below || limits.alarm_above || limits.alarm_below;
  if (!any) {
    map.AddError(
        "output",
        "the threshold has no limit (expected warning_above, warning_below, alarm_above or alarm_below)");
  }
  CheckOrder(map, limits);
  return limits;
}

OutputLimits ReadThresholds(std::vector<YamlMap> maps) {
  OutputLimits thresholds;
  for (YamlMap& map : maps) {
    const std::string output = map.Identifier("output");
    if (std::ranges::find(thresholds, output, &std::pair<std::string, AlarmLimits>::first) !=
        thresholds.end()) {
      map.AddError("output",
                   fmt::format("output {} has a threshold already (expected one for each output)", output));
    }
    thresholds.emplace_back(output, ReadLimits(map));
    map.Finish();
  }
  return thresholds;
}

// Beside the settings file, unless it is absolute; empty where the key is left out.
std::filesystem::path ReadFile(YamlMap& map, std::string_view key, const std::filesystem::path& folder,
                               Presence presence = Presence::kOptional) {
  const std::string name = presence == Presence::kOptional ? map.Text(key, "") : map.Text(key);
  return name.empty() ? std::filesystem::path() : folder / name;
}

// A pipe may never say anything, a device never end.
bool IsPlainOrNew(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  return !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
}

// Of a file that must be there to be read, all at once; empty where it cannot be.
std::filesystem::path ReadableFile(YamlMap& map, std::string_view key, const std::filesystem::path& folder,
                                   std::uintmax_t most_KiB, Presence presence = Presence::kOptional) {
  std::filesystem::path file = ReadFile(map, key, folder, presence);
  if (file.empty()) return file;
  std::error_code error;
  std::string wrong;
  if (!IsPlainOrNew(file)) {
    wrong = fmt::format("is a folder, a pipe or a device (expected a file of at most {} KiB)", most_KiB);
  } else if (!std::ifstream(file)) {
    wrong = "cannot be read (expected a file)";
  } else if (const auto bytes = std::filesystem::file_size(file, error); bytes > most_KiB * 1024) {
    wrong = fmt::format("has {} bytes (expected a file of at most {} KiB)", bytes, most_KiB);
  }
  if (wrong.empty()) return file;
  map.AddError(key, fmt::format("{} = {} {}", key, file.string(), wrong));
  return {};
}

std::string PasswordFrom(const std::filesystem::path& file) {
  std::string line;
  std::ifstream stream(file);
  std::getline(stream, line);
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

// From one of three places; a settings file is read by more people than should know a password.
std::string ReadPassword(YamlMap& map, const std::filesystem::path& folder) {
  std::string password = map.Secret("password", "");
  const std::filesystem::path file = ReadableFile(map, "password_file", folder, kMostPassword_KiB);
  const std::string variable = OptionalIdentifier(map, "password_variable");
  const auto places = map.has("password") + map.has("password_file") + map.has("password_variable");
  if (places > 1) {
    const char* at = map.has("password_variable") ? "password_variable" : "password_file";
    map.AddError(at, fmt::format("{} names a second place for the password (expected one)", at));
  }
  if (!file.empty()) return PasswordFrom(file);
  if (variable.empty()) return password;
  const char* value = std::getenv(variable.c_str());
  if (value == nullptr) {
    map.AddError("password_variable",
                 fmt::format("the environment has no variable {} (expected the password in it)", variable));
    return {};
  }
  return value;
}

TlsSettings ReadTls(YamlMap map, const std::filesystem::path& folder) {
  TlsSettings tls;
  tls.ca_file = ReadableFile(map, "ca_file", folder, kMostCertificates_KiB, Presence::kRequired);
  tls.certificate_file = ReadableFile(map, "certificate_file", folder, kMostCertificates_KiB);
  tls.key_file = ReadableFile(map, "key_file", folder, kMostCertificates_KiB);
  if (map.has("certificate_file") != map.has("key_file")) {
    const char* at = map.has("key_file") ? "key_file" : "certificate_file";
    map.AddError(at, fmt::format("{} stands alone (expected certificate_file and key_file)", at));
  }
  map.Finish();
  return tls;
}

// Written as a URL it may hold a password, and the host stands in messages.
std::string ReadHost(YamlMap& map) {
  std::string host = map.Secret("host", "127.0.0.1");
  if (host.find_first_of("@/") == std::string::npos) return host;
  map.AddError("host",
               "host is more than a name or an address (expected that alone: port, user and password_file "
               "are keys beside it)");
  return {};
}

MqttSettings ReadMqtt(YamlMap map, const std::filesystem::path& folder) {
  MqttSettings mqtt;
  mqtt.host = ReadHost(map);
  mqtt.port = map.Count("port", 1, 65535, map.has("tls") ? "8883" : "1883");
  mqtt.group = map.Identifier("group", "strainwave");
  mqtt.node = map.Identifier("node");
  mqtt.primary_host = OptionalIdentifier(map, "primary_host");
  mqtt.user = map.Text("user", "");
  mqtt.password = ReadPassword(map, folder);
  if (map.has("tls")) {
    mqtt.tls = ReadTls(map.Map("tls", Presence::kRequired), folder);
  } else {
    map.Map("tls", Presence::kOptional);
  }
  mqtt.keep.windows = static_cast<std::size_t>(map.Count("keep_windows", 1, kMostWindows, "10000"));
  mqtt.keep.bytes = static_cast<std::size_t>(map.Count("keep_mebibytes", 1, kMostMebibytes, "64")) << 20;
  mqtt.outbox_file = ReadFile(map, "outbox_file", folder);
  if (!IsPlainOrNew(mqtt.outbox_file)) {
    map.AddError("outbox_file",
                 fmt::format("outbox_file = {} is a folder, a pipe or a device (expected a file, "
                             "or a name for a new one)",
                             mqtt.outbox_file.string()));
  }
  map.Finish();
  return mqtt;
}

StreamSettings ReadSource(YamlMap map, const std::filesystem::path& folder) {
  StreamSettings source;
  const std::string address = map.Text("address");
  try {
    if (!map.is_wrong("address")) source.address = ParseStreamAddress(address);
  } catch (const std::invalid_argument& error) {
    map.AddError("address", error.what());
  }
  if (auto* replay = std::get_if<daq::acquisition::ReplaySettings>(&source.address)) {
    replay->path = folder / replay->path;
    if (!IsPlainOrNew(replay->path)) {
      map.AddError(
          "address",
          fmt::format("address = {} is a folder, a pipe or a device (expected a recorded file)", address));
    }
  }
  source.silent_after_ms =
      Milliseconds(map.Quantity("silent_after", Dimension::kTime, Bound::kPositive, "3 s"));
  source.input_speed_rad_per_s =
      map.OptionalQuantity("input_speed", Dimension::kAngularSpeed, Bound::kNotZero);
  source.operating[OperatingQuantity::kOutputTorque] =
      map.OptionalQuantity("output_torque", Dimension::kTorque, Bound::kNotNegative);
  source.operating[OperatingQuantity::kTemperature] =
      map.OptionalQuantity("temperature", Dimension::kTemperature, Bound::kAny);
  for (YamlMap& channel : map.MapList("channels", Presence::kOptional)) {
    const std::string from = channel.Text("source");
    source.renamed.emplace_back(from, channel.Identifier("name"));
    channel.Finish();
  }
  map.Finish();
  return source;
}

ListenSettings ReadListen(YamlMap map, std::string_view port) {
  ListenSettings listen;
  listen.address = map.Text("address", "127.0.0.1");
  listen.port = map.Count("port", 0, 65535, port);
  listen.connections = static_cast<std::size_t>(map.Count("connections", 1, kMostConnections, "32"));
  const bool is_open = !IsLoopbackAddress(listen.address) && listen.address != "localhost";
  // Of several machines, one leaves room for the rest.
  listen.of_one_network = is_open ? std::max<std::size_t>(listen.connections / 2, 1) : listen.connections;
  listen.idle_after_ms =
      Milliseconds(map.Quantity("idle_after", Dimension::kTime, Bound::kPositive, "1 min"));
  map.Finish();
  return listen;
}

MonitorSettings ReadTop(const YamlNode& root, const std::filesystem::path& folder, ReadContext& context) {
  YamlMap map(root, context);
  map.Version("monitor");
  MonitorSettings settings;
  settings.windows = ReadWindows(map.Map("windows", Presence::kOptional));
  settings.ratio = map.Number("ratio", Bound::kNotZero, "80");
  settings.stale_after_ms =
      Milliseconds(map.Quantity("stale_after", Dimension::kTime, Bound::kPositive, "5 min"));
  settings.limits = ReadThresholds(map.MapList("thresholds", Presence::kOptional));
  if (map.has("source")) settings.source = ReadSource(map.Map("source", Presence::kRequired), folder);
  if (map.has("mqtt")) settings.mqtt = ReadMqtt(map.Map("mqtt", Presence::kRequired), folder);
  if (map.has("prometheus")) {
    settings.prometheus = ReadListen(map.Map("prometheus", Presence::kRequired), "9464");
  }
  if (map.has("modbus")) settings.modbus = ReadListen(map.Map("modbus", Presence::kRequired), "1502");
  for (const char* section : {"source", "mqtt", "prometheus", "modbus"}) {
    if (!map.has(section)) map.Map(section, Presence::kOptional);
  }
  map.Finish();
  return settings;
}

}  // namespace

MonitorSettings ReadMonitorSettings(const std::filesystem::path& path) {
  return ParseMonitorSettings(TextOfFile<MonitorSettingsError>(path, kKind), path.string());
}

MonitorSettings ParseMonitorSettings(const std::string& text, std::string_view file_name) {
  const std::filesystem::path folder = std::filesystem::path(file_name).parent_path();
  return ParseFile<MonitorSettingsError>(
      text, file_name, kKind,
      [&](const YamlNode& root, ReadContext& context) { return ReadTop(root, folder, context); });
}

}  // namespace strainwave::bench
