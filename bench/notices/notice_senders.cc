// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/notices/notice_sender.h"

namespace strainwave::bench {

std::vector<NamedSender> MakeSenders(const NoticeSettings& settings, const GivenUp& given_up) {
  std::vector<NamedSender> senders;
  if (settings.mail) {
    const MailSettings& mail = *settings.mail;
    std::string to = fmt::format("{}", fmt::join(mail.to, ", "));
    if (!mail.escalate_to.empty()) to += fmt::format("; then {}", fmt::join(mail.escalate_to, ", "));
    senders.push_back({"mail", to, MakeMailSender(mail, given_up)});
  }
  // The address of a webhook is often what is secret of it.
  if (settings.webhook) {
    senders.push_back({"webhook", "its URL", MakeWebhookSender(*settings.webhook, given_up)});
  }
  if (settings.mqtt) {
    senders.push_back({"mqtt", fmt::format("{} on {}", settings.mqtt->topic, settings.mqtt->broker),
                       MakeMqttSender(*settings.mqtt, given_up)});
  }
  return senders;
}

}  // namespace strainwave::bench
