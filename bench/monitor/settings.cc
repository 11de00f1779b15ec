// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/settings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {
namespace {

using schedules::Bound;
using schedules::Dimension;
using schedules::FileKind;
using schedules::FindingList;
using schedules::Presence;
using schedules::ReadContext;
using schedules::YamlMap;
using schedules::YamlNode;

constexpr FileKind kKind{"monitor settings", "monitor: 1"};
constexpr int kMostWindows = 10'000'000;
constexpr int kMostMebibytes = 65'536;

std::int64_t Milliseconds(double time_s) { return std::llround(time_s * 1e3); }

// Empty where the key is left out.
std::string OptionalIdentifier(YamlMap& map, std::string_view key) {
  return map.has(key) ? map.Identifier(key) : map.Text(key, "");
}

WindowRule ReadWindows(YamlMap map) {
  using By = WindowRule::By;
  WindowRule rule;
  rule.by = map.Choice<By>("by", {{"trigger", By::kTrigger}, {"revolution", By::kRevolution}}, "trigger");
  rule.trigger_channel = OptionalIdentifier(map, "trigger_channel");
  const bool by_edge = map.has("trigger_channel");
  rule.trigger_level =
      by_edge ? map.Number("trigger_level", Bound::kAny) : map.Number("trigger_level", Bound::kAny, "0");
  rule.turns = map.Number("turns", Bound::kPositive, "1");
  if (rule.by == By::kRevolution && map.has("trigger_channel")) {
    map.AddError("trigger_channel",
                 "trigger_channel has no meaning for windows by revolution (expected 'by: trigger')");
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

MqttSettings ReadMqtt(YamlMap map) {
  MqttSettings mqtt;
  mqtt.host = map.Text("host", "127.0.0.1");
  mqtt.port = map.Count("port", 1, 65535, "1883");
  mqtt.group = map.Identifier("group", "strainwave");
  mqtt.node = map.Identifier("node");
  mqtt.primary_host = OptionalIdentifier(map, "primary_host");
  mqtt.user = map.Text("user", "");
  mqtt.password = map.Text("password", "");
  mqtt.keep.windows = static_cast<std::size_t>(map.Count("keep_windows", 1, kMostWindows, "10000"));
  mqtt.keep.bytes = static_cast<std::size_t>(map.Count("keep_mebibytes", 1, kMostMebibytes, "64")) << 20;
  map.Finish();
  return mqtt;
}

ListenSettings ReadListen(YamlMap map, std::string_view port) {
  ListenSettings listen{map.Text("address", "127.0.0.1"), map.Count("port", 0, 65535, port)};
  map.Finish();
  return listen;
}

MonitorSettings ReadTop(const YamlNode& root, ReadContext& context) {
  YamlMap map(root, context);
  map.Version("monitor");
  MonitorSettings settings;
  settings.windows = ReadWindows(map.Map("windows", Presence::kOptional));
  settings.ratio = map.Number("ratio", Bound::kNotZero, "80");
  settings.stale_after_ms =
      Milliseconds(map.Quantity("stale_after", Dimension::kTime, Bound::kPositive, "5 min"));
  settings.limits = ReadThresholds(map.MapList("thresholds", Presence::kOptional));
  if (map.has("mqtt")) settings.mqtt = ReadMqtt(map.Map("mqtt", Presence::kRequired));
  if (map.has("prometheus")) {
    settings.prometheus = ReadListen(map.Map("prometheus", Presence::kRequired), "9464");
  }
  if (map.has("modbus")) settings.modbus = ReadListen(map.Map("modbus", Presence::kRequired), "1502");
  for (const char* section : {"mqtt", "prometheus", "modbus"}) {
    if (!map.has(section)) map.Map(section, Presence::kOptional);
  }
  map.Finish();
  return settings;
}

}  // namespace

MonitorSettings ReadMonitorSettings(const std::filesystem::path& path) {
  FindingList findings;
  const std::optional<std::string> text = schedules::ReadInputFile(path, kKind, findings);
  if (!text) throw MonitorSettingsError(path.string(), findings);
  return ParseMonitorSettings(*text, path.string());
}

MonitorSettings ParseMonitorSettings(const std::string& text, std::string_view file_name) {
  ReadContext context;
  const std::optional<YamlNode> root = schedules::ParseYaml(text, kKind, context.findings);
  if (!root) throw MonitorSettingsError(file_name, context.findings);
  MonitorSettings settings = ReadTop(*root, context);
  if (context.findings.has_errors()) throw MonitorSettingsError(file_name, context.findings);
  return settings;
}

}  // namespace strainwave::bench
