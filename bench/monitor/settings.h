// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "bench/monitor/outbox.h"
#include "bench/monitor/stream_address.h"
#include "bench/monitor/window.h"
#include "bench/monitor/window_judge.h"
#include "bench/serving/tcp_server.h"
#include "schedules/reader/findings.h"

namespace strainwave::bench {

/// Whom to trust, and who one is. A connection is encrypted where there is a `ca_file`.
struct TlsSettings {
  std::filesystem::path ca_file;           // PEM: who signed the broker's certificate
  std::filesystem::path certificate_file;  // PEM: the monitor's own, where the broker asks for one
  std::filesystem::path key_file;          // PEM, without a passphrase

  bool used() const { return !ca_file.empty(); }
};

struct MqttSettings {
  std::string host;
  int port{};
  std::string group;  // of Sparkplug; with `node` the client's name
  std::string node;
  std::string primary_host;  // whom the data is for; empty: published whoever listens
  std::string user, password;
  TlsSettings tls;
  OutboxBounds keep;
  std::filesystem::path outbox_file;  // empty: what waits is in memory alone
};

/// A device that sends samples, and what it does not say of them.
struct StreamSettings {
  StreamAddress address;
  std::int64_t silent_after_ms{3000};
  std::optional<double> input_speed_rad_per_s;
  OperatingPoint operating;  // where no channel tells it
  std::vector<std::pair<std::string, std::string>>
      renamed;  // the source's name of a channel, the predictor's
};

/// All of a monitor that is not in the predictor's folder.
struct MonitorSettings {
  WindowRule windows;
  double ratio{80.0};  // of the gear, where a stream tells the speed of the input alone
  std::int64_t stale_after_ms{300'000};
  OutputLimits limits;
  std::optional<StreamSettings> source;
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
/// Files that it names and that are not absolute lie beside it. A password is taken from the file that
/// `password_file` names, or the environment variable that `password_variable` does.
/// @throws MonitorSettingsError with every error of the file, each with line and column.
MonitorSettings ReadMonitorSettings(const std::filesystem::path& path);
/// The same for a text, which messages call `file_name`.
MonitorSettings ParseMonitorSettings(const std::string& text, std::string_view file_name);

}  // namespace strainwave::bench
