// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_settings.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "bench/configuration/device_file.h"
#include "bench/devices/tcp_address.h"
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

constexpr FileKind kNoticesFile{"notices", "notices: 1"};
constexpr std::uintmax_t kMostSecret_bytes = 64 * 1024;
constexpr int kMostPerHour = 100;

bool IsPlainAscii(const std::string& text) {
  return std::ranges::all_of(text, [](char c) { return c > ' ' && c < '\x7f'; });
}

// What may stand in an envelope and a header without quotes.
bool IsMailAddress(const std::string& text) {
  const std::size_t at = text.find('@');
  return IsPlainAscii(text) && at != std::string::npos && at > 0 && at + 1 < text.size() &&
         text.find('@', at + 1) == std::string::npos &&
         text.find_first_of("<>()[]\\,;:\"") == std::string::npos;
}

std::vector<std::string> ReadAddresses(YamlMap& map, std::string_view key) {
  std::vector<std::string> addresses = map.TextList(key);
  for (const std::string& address : addresses) {
    if (IsMailAddress(address)) continue;
    map.AddError(key, fmt::format("{} = {} is no mail address (expected NAME@HOST, in ASCII)", key, address));
  }
  return addresses;
}

// The first line of a file beside the settings; empty where the key is left out.
std::string ReadSecret(YamlMap& map, std::string_view key, const std::filesystem::path& folder) {
  const std::string name = map.Text(key, "");
  if (name.empty()) return {};
  const std::filesystem::path file = folder / name;
  std::error_code error;
  std::string line;
  if (!std::filesystem::is_regular_file(file, error) ||
      std::filesystem::file_size(file, error) > kMostSecret_bytes ||
      !std::getline(std::ifstream(file), line)) {
    map.AddError(key, fmt::format("{} = {} cannot be read (expected a file of at most 64 KiB with one line)",
                                  key, file.string()));
    return {};
  }
  if (line.ends_with('\r')) line.pop_back();
  if (line.empty() || line.find('\0') != std::string::npos) {
    map.AddError(
        key, fmt::format("{} = {} has no first line (expected what is secret in it)", key, file.string()));
  }
  return line;
}

std::filesystem::path ReadAuthority(YamlMap& map, const std::filesystem::path& folder) {
  const std::string name = map.Text("ca_file", "");
  if (name.empty()) return {};
  const std::filesystem::path file = folder / name;
  if (!std::ifstream(file)) {
    map.AddError("ca_file",
                 fmt::format("ca_file = {} cannot be read (expected a file in PEM format)", file.string()));
  }
  return file;
}

struct Server {
  std::string text;  // as the file has it
  bool tls{};
  std::string host;
  int port{};
};

// "SCHEME://HOST[:PORT]", or the same with an s behind SCHEME.
Server ReadServer(YamlMap& map, std::string_view key, std::string_view scheme, int port, int tls_port) {
  const std::string text = map.Secret(key);
  const std::string plain = fmt::format("{}://", scheme);
  const std::string safe = fmt::format("{}s://", scheme);
  Server server;
  if (map.is_wrong(key)) return server;
  if (text.find('@') != std::string::npos) {
    map.AddError(key, fmt::format("{} holds more than a host and a port (expected user and password_file as "
                                  "keys of their own)",
                                  key));
    return server;
  }
  server.text = text;
  server.tls = text.starts_with(safe);
  std::string rest = text.substr(server.tls ? safe.size() : std::min(plain.size(), text.size()));
  const bool has_port = rest.find(':') != std::string::npos && !rest.ends_with(']');
  if (!has_port) rest += fmt::format(":{}", server.tls ? tls_port : port);
  try {
    if ((!server.tls && !text.starts_with(plain)) || !IsPlainAscii(text) ||
        rest.find_first_of("/?#") != std::string::npos) {
      throw std::invalid_argument("");
    }
    const TcpAddress address = ParseTcpAddress("tcp:" + rest);
    if (address.port == 0) throw std::invalid_argument("");
    server.host = address.host;
    server.port = address.port;
  } catch (const std::invalid_argument&) {
    map.AddError(key, fmt::format("{} = {} is no address (expected {}HOST:PORT or {}HOST:PORT)", key, text,
                                  plain, safe));
  }
  return server;
}

void RequireBoth(YamlMap& map) {
  if (map.has("user") == map.has("password_file")) return;
  const char* const at = map.has("user") ? "user" : "password_file";
  map.AddError(at, fmt::format("{} stands alone (expected user and password_file)", at));
}

MailSettings ReadMail(YamlMap map, const std::filesystem::path& folder) {
  constexpr int kSmtp = 25;
  constexpr int kSmtps = 465;
  MailSettings mail;
  mail.server = ReadServer(map, "server", "smtp", kSmtp, kSmtps).text;
  mail.from = map.Text("from");
  if (!map.is_wrong("from") && !IsMailAddress(mail.from)) {
    map.AddError("from",
                 fmt::format("from = {} is no mail address (expected NAME@HOST, in ASCII)", mail.from));
  }
  // A list that is not there is an empty one; here it is missing.
  if (map.has("to")) {
    mail.to = ReadAddresses(map, "to");
    if (mail.to.empty()) map.AddError("to", "to names nobody (expected one mail address or more)");
  } else {
    map.Text("to");
  }
  mail.user = map.Text("user", "");
  mail.password = ReadSecret(map, "password_file", folder);
  RequireBoth(map);
  mail.tls = map.Choice<MailTls>(
      "tls", {{"required", MailTls::kRequired}, {"offered", MailTls::kOffered}, {"none", MailTls::kNone}},
      map.has("password_file") ? "required" : "offered");
  mail.ca_file = ReadAuthority(map, folder);
  map.Finish();
  return mail;
}

WebhookSettings ReadWebhook(YamlMap map, const std::filesystem::path& folder) {
  WebhookSettings webhook;
  const bool in_file = map.has("url_file");
  webhook.url = in_file ? ReadSecret(map, "url_file", folder) : map.Secret("url");
  if (in_file) {
    map.Text("url", "");
  } else {
    map.Text("url_file", "");
  }
  if (in_file && map.has("url")) {
    map.AddError("url_file", "url_file stands beside url (expected one of the two)");
  }
  const char* const key = in_file ? "url_file" : "url";
  const bool known = webhook.url.starts_with("http://") || webhook.url.starts_with("https://");
  if (!map.is_wrong(key) && !(known && IsPlainAscii(webhook.url))) {
    map.AddError(key, fmt::format("{} holds no address (expected http://HOST… or https://HOST…)", key));
  }
  webhook.ca_file = ReadAuthority(map, folder);
  map.Finish();
  return webhook;
}

BrokerSettings ReadBroker(YamlMap map, const std::filesystem::path& folder) {
  constexpr int kMqtt = 1883;
  constexpr int kMqtts = 8883;
  BrokerSettings mqtt;
  const Server server = ReadServer(map, "broker", "mqtt", kMqtt, kMqtts);
  mqtt.broker = server.text;
  mqtt.host = server.host;
  mqtt.port = server.port;
  mqtt.tls = server.tls;
  mqtt.topic = map.Text("topic", "strainwave/notices");
  if (mqtt.topic.find_first_of("+#") != std::string::npos) {
    map.AddError("topic",
                 fmt::format("topic = {} has wildcards (expected a topic to publish to)", mqtt.topic));
  }
  mqtt.user = map.Text("user", "");
  mqtt.password = ReadSecret(map, "password_file", folder);
  RequireBoth(map);
  mqtt.ca_file = ReadAuthority(map, folder);
  map.Finish();
  return mqtt;
}

void ReadChannels(YamlMap map, const std::filesystem::path& folder, NoticeSettings& settings) {
  if (map.has("mail")) settings.mail = ReadMail(map.Map("mail", Presence::kRequired), folder);
  if (map.has("webhook")) settings.webhook = ReadWebhook(map.Map("webhook", Presence::kRequired), folder);
  if (map.has("mqtt")) settings.mqtt = ReadBroker(map.Map("mqtt", Presence::kRequired), folder);
  for (const char* section : {"mail", "webhook", "mqtt"}) {
    if (!map.has(section)) map.Map(section, Presence::kOptional);
  }
  map.Finish();
}

void ReadEscalation(YamlMap& map, NoticeSettings& settings) {
  const std::vector<std::string> second = ReadAddresses(map, "escalate_to");
  const double after_s = map.Quantity("escalate_after", Dimension::kTime, Bound::kPositive, "30 min");
  if (!map.has("escalate_to")) {
    if (map.has("escalate_after")) {
      map.AddError("escalate_after",
                   "escalate_after stands alone (expected escalate_to, who gets mail then)");
    }
    return;
  }
  settings.rules.escalate_after_s = after_s;
  if (settings.mail) {
    settings.mail->escalate_to = second;
  } else {
    map.AddError("escalate_to", "escalate_to has no meaning without mail (expected mail among channels)");
  }
}

NoticeSettings ReadNotices(const YamlNode& root, const std::filesystem::path& folder, ReadContext& context) {
  YamlMap map(root, context);
  map.Version("notices");
  NoticeSettings settings;
  NoticeRules& rules = settings.rules;
  ReadChannels(map.Map("channels", Presence::kRequired), folder, settings);
  if (map.has("channels") && !map.is_wrong("channels") && !settings.mail && !settings.webhook &&
      !settings.mqtt) {
    map.AddError("channels", "channels names none (expected mail, webhook or mqtt)");
  }
  rules.delay_s = map.Quantity("delay", Dimension::kTime, Bound::kNotNegative, "2 min");
  ReadEscalation(map, settings);
  rules.silence_after_s = map.Quantity("silence_after", Dimension::kTime, Bound::kPositive, "5 min");
  rules.per_hour = map.Count("rate_per_hour", 2, kMostPerHour, "20");
  map.Finish();
  return settings;
}

}  // namespace

NoticeSettings ReadNoticeSettings(const std::filesystem::path& path) {
  return ParseNoticeSettings(TextOfFile<NoticeSettingsError>(path, kNoticesFile), path.string());
}

NoticeSettings ParseNoticeSettings(const std::string& text, std::string_view file_name) {
  const std::filesystem::path folder = std::filesystem::path(file_name).parent_path();
  return ParseFile<NoticeSettingsError>(
      text, file_name, kNoticesFile,
      [&](const YamlNode& root, ReadContext& context) { return ReadNotices(root, folder, context); });
}

}  // namespace strainwave::bench
