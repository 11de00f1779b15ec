// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/notices/notice_plan.h"
#include "schedules/reader/findings.h"

namespace strainwave::bench {

/// Whether a mail server is spoken to in TLS. smtps:// always is.
enum class MailTls { kRequired, kOffered, kNone };

struct MailSettings {
  std::string server;  // smtp://HOST[:PORT] or smtps://HOST[:PORT]
  std::string from;
  std::vector<std::string> to;
  std::vector<std::string> escalate_to;  // the second list; may be empty
  std::string user, password;
  MailTls tls{MailTls::kOffered};
  std::filesystem::path ca_file;  // PEM: who signed the server's certificate; empty: those of the system
};

struct WebhookSettings {
  std::string url;
  std::filesystem::path ca_file;
};

struct BrokerSettings {
  std::string broker;  // mqtt://HOST[:PORT] or mqtts://HOST[:PORT]
  std::string host;
  int port{};
  bool tls{};
  std::string topic;
  std::string user, password;
  std::filesystem::path ca_file;
};

struct NoticeSettings {
  std::optional<MailSettings> mail;
  std::optional<WebhookSettings> webhook;
  std::optional<BrokerSettings> mqtt;
  NoticeRules rules;
};

/// A settings file that cannot be used.
class NoticeSettingsError : public schedules::FileError {
 public:
  using FileError::FileError;
};

/// Reads the file (`notices: 1`; bench/notices/notices.yaml has every key). Files that it names and that are
/// not absolute lie beside it. Passwords are the first line of the files that `password_file` names, and
/// stand nowhere else.
/// @throws NoticeSettingsError with every error of the file, each with line and column.
NoticeSettings ReadNoticeSettings(const std::filesystem::path& path);
/// The same for a text, which messages call `file_name`.
NoticeSettings ParseNoticeSettings(const std::string& text, std::string_view file_name);

}  // namespace strainwave::bench
