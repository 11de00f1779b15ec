// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/notices/notice.h"
#include "bench/notices/notice_settings.h"

namespace strainwave::bench {

/// One way to people or programs. Of one thread.
class NoticeSender {
 public:
  /// @return why the notice was not taken, in one line without a secret; empty: it was.
  virtual std::string Send(const Notice& notice) = 0;
  virtual ~NoticeSender() = default;
};

/// Whether to give up what is under way.
using GivenUp = std::function<bool()>;

struct NamedSender {
  std::string name;  // mail, webhook, mqtt
  std::string to;    // whom it reaches, for people; without a secret
  std::unique_ptr<NoticeSender> sender;
};

/// A channel answers within this time, or the notice is tried again later.
inline constexpr int kConnectTimeout_s = 10;
inline constexpr int kSendTimeout_s = 30;

std::unique_ptr<NoticeSender> MakeMailSender(const MailSettings& settings, GivenUp given_up);
std::unique_ptr<NoticeSender> MakeWebhookSender(const WebhookSettings& settings, GivenUp given_up);
std::unique_ptr<NoticeSender> MakeMqttSender(const BrokerSettings& settings, GivenUp given_up);

/// All that the settings name.
std::vector<NamedSender> MakeSenders(const NoticeSettings& settings, const GivenUp& given_up);

}  // namespace strainwave::bench
