// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <mosquitto.h>
#include <nlohmann/json.hpp>

#include "bench/notices/notice_sender.h"

namespace strainwave::bench {
namespace {

using std::chrono::steady_clock;

constexpr int kNoticeKeepAlive_s = 60;
constexpr int kNoticeLoop_ms = 50;

struct MosquittoLibrary {
  MosquittoLibrary() { mosquitto_lib_init(); }
  MosquittoLibrary(const MosquittoLibrary&) = delete;
  MosquittoLibrary& operator=(const MosquittoLibrary&) = delete;
  ~MosquittoLibrary() { mosquitto_lib_cleanup(); }
};

/// A connection for one notice: it is over when the broker has acknowledged that, or does not in time.
class MqttDelivery {
 public:
  MqttDelivery(const BrokerSettings& settings, std::string payload)
      : settings_(settings),
        payload_(std::move(payload)),
        client_(mosquitto_new(nullptr, true, this), mosquitto_destroy) {
    mosquitto* const client = client_.get();
    if (!settings.user.empty()) {
      Check(mosquitto_username_pw_set(client, settings.user.c_str(), settings.password.c_str()));
    }
    if (settings.tls) {
      const bool of_system = settings.ca_file.empty();
      Check(mosquitto_tls_set(client, of_system ? nullptr : settings.ca_file.c_str(),
                              of_system ? "/etc/ssl/certs" : nullptr, nullptr, nullptr, nullptr));
    }
    mosquitto_connect_callback_set(
        client, [](mosquitto*, void* self, int code) { static_cast<MqttDelivery*>(self)->OnConnect(code); });
    mosquitto_publish_callback_set(
        client, [](mosquitto*, void* self, int) { static_cast<MqttDelivery*>(self)->done_ = true; });
  }

  std::string Deliver(const GivenUp& given_up) {
    const auto begun = steady_clock::now();
    if (trouble_.empty()) {
      Check(
          mosquitto_connect_async(client_.get(), settings_.host.c_str(), settings_.port, kNoticeKeepAlive_s));
    }
    while (trouble_.empty() && !done_) {
      Check(mosquitto_loop(client_.get(), kNoticeLoop_ms, 1));
      const std::chrono::seconds limit(accepted_ ? kSendTimeout_s : kConnectTimeout_s);
      if (!done_ && steady_clock::now() - begun > limit) Lose("no answer in time");
      if (given_up()) Lose("given up");
    }
    if (!done_) return trouble_;
    mosquitto_disconnect(client_.get());
    mosquitto_loop(client_.get(), 0, 1);
    return {};
  }

 private:
  void OnConnect(int code) {
    if (code != 0) return Lose(mosquitto_connack_string(code));
    accepted_ = true;
    constexpr int kAtLeastOnce = 1;
    Check(mosquitto_publish(client_.get(), nullptr, settings_.topic.c_str(),
                            static_cast<int>(payload_.size()), payload_.data(), kAtLeastOnce, false));
  }

  void Check(int code) {
    if (code != MOSQ_ERR_SUCCESS && code != MOSQ_ERR_CONN_PENDING) Lose(mosquitto_strerror(code));
  }
  void Lose(const std::string& cause) {
    if (trouble_.empty()) trouble_ = cause;
  }

  const BrokerSettings& settings_;
  const std::string payload_;
  std::unique_ptr<mosquitto, void (*)(mosquitto*)> client_;
  bool accepted_{};
  bool done_{};  // acknowledged
  std::string trouble_;
};

class MqttSender : public NoticeSender {
 public:
  MqttSender(BrokerSettings settings, GivenUp given_up)
      : settings_(std::move(settings)), given_up_(std::move(given_up)) {
    static const MosquittoLibrary library;
  }

  std::string Send(const Notice& notice) override {
    MqttDelivery delivery(settings_,
                          NoticeJson(notice).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    return delivery.Deliver(given_up_);
  }

 private:
  const BrokerSettings settings_;
  const GivenUp given_up_;
};

}  // namespace

std::unique_ptr<NoticeSender> MakeMqttSender(const BrokerSettings& settings, GivenUp given_up) {
  return std::make_unique<MqttSender>(settings, std::move(given_up));
}

}  // namespace strainwave::bench
