// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include "bench/notices/curl_transfer.h"
#include "bench/notices/mail_message.h"
#include "bench/notices/notice_sender.h"

namespace strainwave::bench {
namespace {

std::size_t GiveMail(char* to, std::size_t size, std::size_t count, void* rest) {
  auto& left = *static_cast<std::string_view*>(rest);
  const std::size_t taken = std::min(size * count, left.size());
  std::memcpy(to, left.data(), taken);
  left.remove_prefix(taken);
  return taken;
}

long TlsLevel(MailTls tls) {
  switch (tls) {
    case MailTls::kRequired:
      return CURLUSESSL_ALL;
    case MailTls::kOffered:
      return CURLUSESSL_TRY;
    case MailTls::kNone:
      return CURLUSESSL_NONE;
  }
  return CURLUSESSL_ALL;
}

class MailSender : public NoticeSender {
 public:
  MailSender(MailSettings settings, GivenUp given_up)
      : settings_(std::move(settings)), given_up_(std::move(given_up)) {}

  std::string Send(const Notice& notice) override {
    const std::vector<std::string> to = RecipientsOf(notice, settings_.to, settings_.escalate_to);
    const std::string message = MailMessage(notice, settings_.from, to);
    std::string_view rest = message;
    CurlTransfer transfer(given_up_, settings_.ca_file);
    CURL* const curl = transfer.handle();
    CurlList recipients;
    for (const std::string& address : to) Append(recipients, "<" + address + ">");
    curl_easy_setopt(curl, CURLOPT_URL, settings_.server.c_str());
    curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "smtp,smtps");
    curl_easy_setopt(curl, CURLOPT_USE_SSL, TlsLevel(settings_.tls));
    if (!settings_.user.empty()) {
      curl_easy_setopt(curl, CURLOPT_USERNAME, settings_.user.c_str());
      curl_easy_setopt(curl, CURLOPT_PASSWORD, settings_.password.c_str());
    }
    curl_easy_setopt(curl, CURLOPT_MAIL_FROM, ("<" + settings_.from + ">").c_str());
    curl_easy_setopt(curl, CURLOPT_MAIL_RCPT, recipients.get());
    // One address that is wrong keeps the mail from none of the others.
    curl_easy_setopt(curl, CURLOPT_MAIL_RCPT_ALLLOWFAILS, 1L);
    curl_easy_setopt(curl, CURLOPT_UPLOAD, 1L);
    curl_easy_setopt(curl, CURLOPT_READFUNCTION, &GiveMail);
    curl_easy_setopt(curl, CURLOPT_READDATA, &rest);
    return transfer.Perform();
  }

 private:
  const MailSettings settings_;
  const GivenUp given_up_;
};

}  // namespace

std::unique_ptr<NoticeSender> MakeMailSender(const MailSettings& settings, GivenUp given_up) {
  return std::make_unique<MailSender>(settings, std::move(given_up));
}

}  // namespace strainwave::bench
