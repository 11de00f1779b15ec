// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/mqtt_publisher.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <mosquitto.h>

#include "bench/errors/bench_error.h"
#include "bench/monitor/mqtt_tls.h"
#include "bench/monitor/sparkplug_metrics.h"

namespace strainwave::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kKeepAlive_s = 10;
constexpr int kLoop_ms = 10;
constexpr std::size_t kMostUnderWay = 20;  // what libmosquitto itself lets pass at a time
constexpr milliseconds kFirstPause{100};
constexpr milliseconds kLongestPause{5000};
constexpr milliseconds kAnswer{10'000};  // for a broker to accept a connection
constexpr milliseconds kForState{2000};  // for a retained state of the primary host to come
constexpr milliseconds kFarewell{1000};  // for a broker to acknowledge a death

struct Library {
  Library() { mosquitto_lib_init(); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() { mosquitto_lib_cleanup(); }
};

}  // namespace

/// One connection from its will to its end. libmosquitto keeps nothing from one to the next.
class MqttPublisher::Connection {
 public:
  explicit Connection(MqttPublisher& publisher)
      : publisher_(publisher),
        will_(publisher.Death()),
        client_(
            mosquitto_new((publisher.settings_.group + "-" + publisher.settings_.node).c_str(), true, this),
            mosquitto_destroy) {
    mosquitto* const client = client_.get();
    const MqttSettings& settings = publisher.settings_;
    mosquitto_will_set(client, will_.topic.c_str(), static_cast<int>(will_.payload.size()),
                       will_.payload.data(), will_.qos, will_.retain);
    if (!settings.user.empty()) {
      mosquitto_username_pw_set(client, settings.user.c_str(), settings.password.c_str());
    }
    if (settings.tls.used()) tls_ = std::make_unique<TlsHandshake>(client, settings);
    mosquitto_log_callback_set(client, [](mosquitto*, void* self, int level, const char* line) {
      if (level == MOSQ_LOG_ERR) static_cast<Connection*>(self)->said_ += std::string(line) + '\n';
    });
    mosquitto_connect_callback_set(
        client, [](mosquitto*, void* self, int code) { static_cast<Connection*>(self)->OnConnect(code); });
    mosquitto_message_callback_set(client, [](mosquitto*, void* self, const mosquitto_message* message) {
      static_cast<Connection*>(self)->OnMessage(*message);
    });
    mosquitto_publish_callback_set(client, [](mosquitto*, void* self, int ticket) {
      static_cast<Connection*>(self)->OnAcknowledged(ticket);
    });
  }

  /// Until the connection is lost, the primary host leaves, or there is nothing more to do.
  /// @return whether there was a birth.
  bool Serve() {
    const MqttSettings& settings = publisher_.settings_;
    const auto start = steady_clock::now();
    Check(mosquitto_connect_async(client_.get(), settings.host.c_str(), settings.port, kKeepAlive_s));
    while (!lost_ && !publisher_.Finished()) {
      Check(mosquitto_loop(client_.get(), kLoop_ms, 1));
      LetGo();
      if (!accepted_ && steady_clock::now() - start > kAnswer) Lose("no answer");
      if (accepted_ && !lost_ && host_online_ && (!born_ || asked_for_birth_)) Birth();
      const bool is_told = !host_said_.empty() || steady_clock::now() - accepted_at_ > kForState;
      if (accepted_ && !lost_ && !host_online_ && !born_ && is_told) publisher_.TellWaiting(Waiting());
      if (born_ && !host_online_) {
        cause_ = "the primary host does not listen";
        break;
      }
      if (born_ && !lost_) SendWaiting();
    }
    if (accepted_ && !lost_) Farewell();
    LetGo();
    return born_;
  }

  const std::string& cause() const { return cause_; }

  /// What keeps the windows here while nothing is wrong with the connection.
  std::string Waiting() const {
    const MqttSettings& settings = publisher_.settings_;
    if (!accepted_) return fmt::format("no answer yet from {} port {}", settings.host, settings.port);
    if (born_) return "the broker did not acknowledge them in time";
    const std::string& host = settings.primary_host;
    return fmt::format("waits for the primary host {}: {}", host,
                       host_said_.empty()
                           ? fmt::format("nothing is heard on {} (Sparkplug 3.0) or {} (2.2)",
                                         protocols::HostStateTopic(host), protocols::OldHostStateTopic(host))
                           : host_said_);
  }

 private:
  void OnConnect(int code) {
    if (code != 0) {
      Lose(mosquitto_connack_string(code));
      return;
    }
    accepted_ = true;
    accepted_at_ = steady_clock::now();
    Check(mosquitto_subscribe(client_.get(), nullptr, publisher_.node_.CommandTopic().c_str(), 1));
    const std::string& host = publisher_.settings_.primary_host;
    host_online_ = host.empty();
    if (!host.empty()) {
      Check(mosquitto_subscribe(client_.get(), nullptr, protocols::HostStateTopic(host).c_str(), 1));
      Check(mosquitto_subscribe(client_.get(), nullptr, protocols::OldHostStateTopic(host).c_str(), 1));
    }
  }

  void OnMessage(const mosquitto_message& message) {
    const std::string_view payload(static_cast<const char*>(message.payload),
                                   static_cast<std::size_t>(message.payloadlen));
    if (message.topic == publisher_.node_.CommandTopic()) {
      asked_for_birth_ = asked_for_birth_ || protocols::AsksForRebirth(payload);
      return;
    }
    const auto state = protocols::ParseHostState(payload);
    if (!state) {
      if (!host_time_ms_)
        host_said_ = fmt::format("what is heard on {} is no state of a host", message.topic);
      return;
    }
    // A host of both versions is believed by the newer one, where an old word cannot come last.
    if (host_time_ms_ && (!state->time_ms || *state->time_ms < *host_time_ms_)) return;
    host_time_ms_ = state->time_ms;
    host_online_ = state->online;
    host_said_ = fmt::format("it says on {} that it is {}line", message.topic, state->online ? "on" : "off");
  }

  // libmosquitto also calls this from within a publish, where the mutex may be held.
  void OnAcknowledged(int ticket) {
    if (ticket == farewell_) farewell_done_ = true;
    acknowledged_.push_back(ticket);
  }

  void LetGo() {
    if (acknowledged_.empty()) return;
    const std::scoped_lock lock(publisher_.mutex_);
    publisher_.outbox_.Acknowledge(acknowledged_);
    acknowledged_.clear();
    publisher_.ShowLink();
  }

  // Under the mutex: what is put into the outbox after the birth's own time is live.
  void Birth() {
    const std::scoped_lock lock(publisher_.mutex_);
    const Board& board = publisher_.board_;
    const std::int64_t now_ms = board.NowMilliseconds();
    Send(publisher_.node_.Birth(now_ms, SparkplugMetrics(board.State(), board.frame(), now_ms)), nullptr);
    asked_for_birth_ = false;
    if (lost_) return;
    if (!std::exchange(born_, true)) {
      publisher_.log_(fmt::format("mqtt: published the birth of {}/{}", publisher_.settings_.group,
                                  publisher_.settings_.node));
      publisher_.told_broken_ = false;
      publisher_.told_waiting_.clear();
    }
    publisher_.live_ = true;
    publisher_.ShowLink();
  }

  void SendWaiting() {
    const std::scoped_lock lock(publisher_.mutex_);
    Outbox& outbox = publisher_.outbox_;
    while (!lost_ && outbox.under_way() < kMostUnderWay) {
      const auto* metrics = outbox.Next();
      if (metrics == nullptr) return;
      protocols::MqttMessage message = publisher_.node_.Data(publisher_.board_.NowMilliseconds(), *metrics);
      message.qos = 1;
      int ticket = 0;
      Send(message, &ticket);
      if (!lost_) outbox.Sent(ticket);
    }
  }

  // A connection that is ended on purpose takes its will with it: the death is published by hand.
  void Farewell() {
    const auto start = steady_clock::now();
    if (born_) {
      Send(will_, &farewell_);
      while (!lost_ && !farewell_done_ && steady_clock::now() - start < kFarewell) {
        Check(mosquitto_loop(client_.get(), kLoop_ms, 1));
      }
    }
    mosquitto_disconnect(client_.get());
    mosquitto_loop(client_.get(), kLoop_ms, 1);
  }

  void Send(const protocols::MqttMessage& message, int* ticket) {
    Check(mosquitto_publish(client_.get(), ticket, message.topic.c_str(),
                            static_cast<int>(message.payload.size()), message.payload.data(), message.qos,
                            message.retain));
  }

  void Check(int code) {
    if (code == MOSQ_ERR_SUCCESS || code == MOSQ_ERR_CONN_PENDING) return;
    // What TLS objects to, and not that the connection is gone then.
    const std::string by_tls = tls_ && !accepted_ ? tls_->WhyFailed(said_) : "";
    Lose(by_tls.empty() ? mosquitto_strerror(code) : by_tls);
  }

  void Lose(const std::string& cause) {
    if (!lost_) cause_ = cause;
    lost_ = true;
  }

  MqttPublisher& publisher_;
  protocols::MqttMessage will_;
  std::unique_ptr<TlsHandshake> tls_;  // null: not encrypted; outlives the client
  std::unique_ptr<mosquitto, void (*)(mosquitto*)> client_;
  bool accepted_{};
  bool born_{};
  bool lost_{};
  bool host_online_{};
  std::optional<std::int64_t> host_time_ms_;  // of its last word; nothing in Sparkplug 2.2
  std::string host_said_;
  steady_clock::time_point accepted_at_{};
  bool asked_for_birth_{};
  std::vector<int> acknowledged_;
  int farewell_{-1};
  bool farewell_done_{};
  std::string said_;  // by libmosquitto, of its errors
  std::string cause_;
};

MqttPublisher::MqttPublisher(const MqttSettings& settings, Board& board, Log log,
                             std::unique_ptr<OutboxStore> store)
    : settings_(settings),
      board_(board),
      log_(std::move(log)),
      node_(settings.group, settings.node, store ? store->next_birth() : 0),
      outbox_(settings.keep, std::move(store)),
      dropped_before_(outbox_.dropped()) {
  RequireUsable(settings.tls);
  RequireSameMetrics();
  if (outbox_.size() > 0) {
    log_(fmt::format("mqtt: {} windows of an earlier run wait in {}", outbox_.size(),
                     settings.outbox_file.string()));
  }
  ShowLink();
  thread_ = std::thread([this] { Run(); });
}

MqttPublisher::~MqttPublisher() {
  if (thread_.joinable()) Finish(milliseconds{0});
}

// A birth names all metrics that there will be, and what waits is sent after it.
void MqttPublisher::RequireSameMetrics() const {
  const auto born = SparkplugMetrics(board_.State(), board_.frame(), board_.NowMilliseconds());
  for (std::size_t i = 0; const auto* waiting = outbox_.At(i); ++i) {
    if (!std::ranges::equal(*waiting, born, {}, &protocols::SparkplugMetric::name,
                            &protocols::SparkplugMetric::name)) {
      Refuse(
          settings_.outbox_file,
          fmt::format("of the {} windows that wait, number {} is another predictor's", outbox_.size(), i + 1),
          "the predictor whose results they are, or another outbox_file");
    }
  }
}

protocols::MqttMessage MqttPublisher::Death() {
  protocols::MqttMessage death = node_.Death(board_.NowMilliseconds());
  const std::scoped_lock lock(mutex_);
  outbox_.KeepNextBirth(node_.next_birth());
  ShowLink();
  return death;
}

void MqttPublisher::Publish(std::vector<protocols::SparkplugMetric> metrics) {
  const std::scoped_lock lock(mutex_);
  outbox_.Push(std::move(metrics), live_);
  ShowLink();
}

MqttPublisher::NotDelivered MqttPublisher::Finish(milliseconds patience) {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
    deadline_ = steady_clock::now() + patience;
  }
  wake_.notify_all();
  thread_.join();
  return {outbox_.size(), outbox_.dropped() - dropped_before_, waits_for_};
}

bool MqttPublisher::Finished() {
  const std::scoped_lock lock(mutex_);
  return FinishedLocked();
}

bool MqttPublisher::FinishedLocked() const {
  return stopping_ && (outbox_.size() == 0 || steady_clock::now() >= deadline_);
}

void MqttPublisher::ShowLink() {
  board_.Show(LinkState{true, live_, outbox_.size(), outbox_.bytes(), outbox_.dropped()});
  if (outbox_.trouble() == told_trouble_) return;
  told_trouble_ = outbox_.trouble();
  log_(told_trouble_.empty()
           ? fmt::format("mqtt: {} can be written again", settings_.outbox_file.string())
           : fmt::format("mqtt: {} (what waits is in memory alone meanwhile)", told_trouble_));
}

void MqttPublisher::TellWaiting(const std::string& words) {
  if (words == std::exchange(told_waiting_, words)) return;
  const std::scoped_lock lock(mutex_);
  log_(fmt::format("mqtt: {}; nothing is sent meanwhile, {} windows wait", words, outbox_.size()));
}

void MqttPublisher::Run() {
  const Library library;
  milliseconds pause = kFirstPause;
  while (!Finished()) {
    bool was_born = false;
    std::string cause;
    try {
      Connection connection(*this);
      was_born = connection.Serve();
      cause = connection.cause();
      waits_for_ = connection.Waiting();
    } catch (const BenchError& error) {
      cause = error.what();  // a certificate that is being exchanged: the next try may find it
    }
    if (!cause.empty())
      waits_for_ = fmt::format("no connection to {} port {}: {}", settings_.host, settings_.port, cause);
    std::unique_lock lock(mutex_);
    outbox_.ConnectionLost();
    live_ = false;
    ShowLink();
    if (FinishedLocked()) return;
    const bool other_cause = cause != std::exchange(told_cause_, cause);
    if (!std::exchange(told_broken_, true) || was_born || other_cause) {
      log_(fmt::format("mqtt: {}; {} windows wait", waits_for_, outbox_.size()));
    }
    pause = was_born ? kFirstPause : std::min(2 * pause, kLongestPause);
    wake_.wait_for(lock, pause, [this] { return FinishedLocked(); });
  }
}

}  // namespace strainwave::bench
