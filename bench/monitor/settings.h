// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "bench/monitor/outbox.h"
#include "bench/monitor/window.h"
#include "bench/monitor/window_judge.h"
#include "schedules/reader/findings.h"

namespace strainwave::bench {

struct MqttSettings {
  std::string host;
  int port{};
  std::string group;  // of Sparkplug; with `node` the client's name
  std::string node;
  std::string primary_host;  // whom the data is for; empty: published whoever listens
  std::string user, password;
  OutboxBounds keep;
};

/// Where a server listens; port 0 is any free one.
struct ListenSettings {
  std::string address;
  int port{};
};

/// All of a monitor that is not in the predictor's folder.
struct MonitorSettings {
  WindowRule windows;
  double ratio{80.0};  // of the gear, where a stream tells the speed of the input alone
  std::int64_t stale_after_ms{300'000};
  OutputLimits limits;
  std::optional<MqttSettings> mqtt;
  std::optional<ListenSettings> prometheus;
  std::optional<ListenSettings> modbus;
};

/// A settings file that cannot be used.
class MonitorSettingsError : public schedules::FileError {
 public:
  using FileError::FileError;
};

/// Reads the file (`monitor: 1`; bench/monitor/monitor.yaml has every key).
/// @throws MonitorSettingsError with every error of the file, each with line and column.
MonitorSettings ReadMonitorSettings(const std::filesystem::path& path);
/// The same for a text, which messages call `file_name`.
MonitorSettings ParseMonitorSettings(const std::string& text, std::string_view file_name);

}  // namespace strainwave::bench
