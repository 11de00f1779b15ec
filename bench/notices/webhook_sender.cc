// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/notices/curl_transfer.h"
#include "bench/notices/notice_sender.h"

namespace strainwave::bench {
namespace {

class WebhookSender : public NoticeSender {
 public:
  WebhookSender(WebhookSettings settings, GivenUp given_up)
      : settings_(std::move(settings)), given_up_(std::move(given_up)) {}

  std::string Send(const Notice& notice) override {
    const std::string body =
        NoticeJson(notice).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    CurlTransfer transfer(given_up_, settings_.ca_file);
    CURL* const curl = transfer.handle();
    CurlList headers;
    Append(headers, "Content-Type: application/json");
    Append(headers, "Expect:");  // no question first whether the body may come
    curl_easy_setopt(curl, CURLOPT_URL, settings_.url.c_str());
    curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers.get());
    curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(body.size()));
    curl_easy_setopt(curl, CURLOPT_POSTFIELDS, body.c_str());
    if (std::string trouble = transfer.Perform(); !trouble.empty()) return trouble;
    long status = 0;
    curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &status);
    constexpr long kLeastGood = 200;
    constexpr long kMostGood = 299;
    if (status >= kLeastGood && status <= kMostGood) return {};
    return fmt::format("the server answers {} (expected {} to {})", status, kLeastGood, kMostGood);
  }

 private:
  const WebhookSettings settings_;
  const GivenUp given_up_;
};

}  // namespace

std::unique_ptr<NoticeSender> MakeWebhookSender(const WebhookSettings& settings, GivenUp given_up) {
  return std::make_unique<WebhookSender>(settings, std::move(given_up));
}

}  // namespace strainwave::bench
