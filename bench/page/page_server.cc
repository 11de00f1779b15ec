// SPDX-License-Identifier: Apache-2.0
#include "bench/page/page_server.h"

#include <exception>
#include <iterator>
#include <mutex>
#include <vector>

#include <fmt/core.h>
#include <httplib.h>

#include "bench/page/action_desk.h"
#include "bench/page/campaign_watch.h"
#include "bench/page/event_stream.h"
#include "bench/page/http_text.h"
#include "bench/page/logins.h"
#include "bench/page/page_gate.h"
#include "bench/page/page_questions.h"
#include "bench/page/page_state.h"
#include "bench/page/static_files.h"
#include "bench/page/time_zone.h"
#include "bench/page/viewers.h"
#include "bench/serving/http_exchange.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kLongestHead_bytes = 8192;
constexpr std::size_t kLongestBody_bytes = 4096;
constexpr std::size_t kMostStreams = 100;
constexpr std::size_t kMostConnections = 300;
constexpr std::int64_t kIdleAfter_ms = 10'000;
constexpr std::chrono::seconds kHeartbeat{1};
constexpr const char* kJson = "application/json";

// A viewer on a slow network has time for a frame; one that takes none is closed, and comes back by itself.
constexpr ServerLimits kLimits{.longest_request_bytes = kLongestHead_bytes + kLongestBody_bytes,
                               .request_within = std::chrono::seconds(2),
                               .answer_within = std::chrono::seconds(10),
                               .most_unsent_bytes = 256 * 1024,
                               .lingers = true};

}  // namespace

// Called from the server's thread alone, but for `Finish` and `Wake`.
class PageServer::Pages : public httplib::Server, public RequestProtocol {
 public:
  explicit Pages(const PageSettings& settings)
      : folder_(settings.folder),
        scheme_(settings.tls == nullptr ? "http://" : "https://"),
        gate_(settings.address, settings.names),
        watch_(folder_),
        logins_(settings.users_file, fmt::format("strainwave_{:.16}", watch_.Snapshot().run),
                settings.tls != nullptr),
        desk_(folder_, settings.complain),
        questions_(folder_, settings.predictor, settings.baseline) {
    set_default_headers({AnswerHeaders().begin(), AnswerHeaders().end()});
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      return Route(request, response) ? HandlerResponse::Handled : HandlerResponse::Unhandled;
    });
    PostHere(kActionsPath, &Pages::TakeAction);
    PostHere(kLoginPath, &Pages::LogIn);
    PostHere(kLogoutPath, &Pages::LogOut);
    set_error_handler([](const httplib::Request&, httplib::Response& response) {
      if (!response.body.empty()) return;
      response.set_content(ErrorJson("the request cannot be read (expected HTTP/1.1)"), kJson);
    });
  }

  void Begin(TcpServer& server) {
    {
      const std::lock_guard lock(mutex_);
      server_ = &server;
    }
    watch_.Begin([this] { Wake(); });
  }

  // Here all come from one machine; from others, one leaves room for the rest.
  std::size_t MostOfOneNetwork() const { return gate_.is_open() ? kMostConnections : kMostConnections / 3; }

  // From now on nobody wakes the server.
  void End() {
    const std::lock_guard lock(mutex_);
    server_ = nullptr;
  }

  std::optional<std::size_t> LengthOf(std::string_view received) override {
    const auto head = HeadOf(received);
    if (!head) return std::nullopt;
    // A body that is too long is not waited for.
    if (head->is_chunked || head->is_ambiguous || head->body_bytes > kLongestBody_bytes) return head->bytes;
    const std::size_t length = head->bytes + head->body_bytes;
    return length <= received.size() ? std::optional(length) : std::nullopt;
  }

  Reply Answer(std::string_view request, const Caller& caller) override {
    const auto head = HeadOf(request);
    if (head->is_ambiguous) return Refused(400, "Content-Length (expected one whole number)");
    if (head->is_chunked)
      return Refused(411, "the length of the body is not given (expected Content-Length)");
    if (head->bytes > kLongestHead_bytes) return {LastWords(Refusal::kTooLong), true};
    if (head->body_bytes > kLongestBody_bytes) {
      return Refused(413, fmt::format("the body has {} bytes (expected at most {})", head->body_bytes,
                                      kLongestBody_bytes));
    }
    caller_ = caller;
    waits_.reset();
    HttpExchange exchange(request);
    bool closed = false;
    try {
      // Packed as browsers like it, a file would keep this thread for half a second: Debian's library packs
      // with Brotli as tightly as it can.
      process_request(exchange, true, closed,
                      [](httplib::Request& asked) { asked.headers.erase("Accept-Encoding"); });
    } catch (const std::exception&) {
      return Refused(400, "the request cannot be read (expected HTTP/1.1)");
    }
    if (waits_) return {.bytes = std::move(*waits_), .waits = true};
    return {.bytes = exchange.answer(), .closes = true};
  }

  std::vector<Delivery> Deliveries(Time now) override {
    std::vector<Delivery> deliveries;
    {
      const std::lock_guard lock(mutex_);
      deliveries.swap(finished_);
    }
    const bool changed = watch_.version() != version_;
    if (viewers_.count() == 0 || (!changed && now < heartbeat_due_)) return deliveries;
    heartbeat_due_ = now + kHeartbeat;
    const auto add = [&](std::vector<Delivery> more) {
      deliveries.insert(deliveries.end(), std::make_move_iterator(more.begin()),
                        std::make_move_iterator(more.end()));
    };
    // Whoever is logged out sees nothing any more.
    if (!gate_.is_open()) {
      add(viewers_.EndWhere([&](const std::string& session) { return !logins_.Holds(session, now); }));
    }
    if (!changed) {
      add(viewers_.Alive(UtcMilliseconds()));
      return deliveries;
    }
    const WatchedCampaign newest = watch_.Newest();
    version_ = newest.version;
    add(viewers_.News(newest, Now()));
    return deliveries;
  }

  void Left(ClientId client) override { viewers_.Remove(client); }

  std::string LastWords(Refusal why) override {
    switch (why) {
      case Refusal::kTooLong:
        return HttpAnswer(
            431, kJson,
            ErrorJson(fmt::format("the head of the request is too long (expected at most {} bytes)",
                                  kLongestHead_bytes)));
      case Refusal::kTooSlow:
        return HttpAnswer(408, kJson,
                          ErrorJson(fmt::format("the request was not whole in time (expected: within {} s)",
                                                kLimits.request_within.count())));
    }
    return {};
  }

 private:
  static Reply Refused(int status, std::string_view sentence) {
    return {HttpAnswer(status, kJson, ErrorJson(sentence)), true};
  }

  static void Refuse(httplib::Response& response, int status, std::string_view sentence) {
    response.status = status;
    response.set_content(ErrorJson(sentence), kJson);
  }

  using Handling = void (Pages::*)(const httplib::Request&, httplib::Response&);

  // What changes something, asked for by this page itself.
  void PostHere(const char* path, Handling handling) {
    Post(path, [this, handling](const httplib::Request& request, httplib::Response& response) {
      if (!IsOwnOrigin(request.get_header_value("Origin"), scheme_, request.get_header_value("Host"))) {
        return Refuse(response, 403, "actions of another page are not taken (expected this page's own)");
      }
      if (!request.get_header_value("Content-Type").starts_with(kJson)) {
        return Refuse(response, 400, "the Content-Type is not application/json (expected that of JSON)");
      }
      (this->*handling)(request, response);
    });
  }

  // Of all requests but those of `PostHere`, whose bodies are not read yet. One that is packed is not
  // unpacked: four kilobytes may hold gigabytes.
  bool Route(const httplib::Request& request, httplib::Response& response) {
    if (const auto wrong = gate_.WrongHost(request.get_header_value("Host"), caller_.own_address)) {
      Refuse(response, 403, *wrong);
    } else if (gate_.IsGuarded(request.path) && !IsLoggedIn(request)) {
      response.status = 401;
      response.set_content(JsonText(MustLogIn()) + "\n", kJson);
    } else if (request.has_header("Content-Encoding")) {
      Refuse(response, 415, "the body is packed (expected plain JSON, without Content-Encoding)");
    } else if (request.path == kActionsPath || request.path == kLoginPath || request.path == kLogoutPath) {
      if (request.method == "POST") return false;
      Refuse(response, 405, "actions are sent by POST");
    } else if (request.method != "GET" && request.method != "HEAD") {
      Refuse(response, 405, fmt::format("{:.20} is not done here (expected GET)", request.method));
    } else if (request.path == "/api/v1/state") {
      SendState(request, response);
    } else if (request.path == "/api/v1/events") {
      OpenStream(request, response);
    } else if (const StaticFile* file = FindStaticFile(request.path)) {
      response.status = 200;
      response.set_content(file->bytes.data(), file->bytes.size(), std::string(file->type));
    } else if (const auto taken = Ask(request)) {
      if (!taken->sentence.empty()) Refuse(response, taken->status, taken->sentence);
      if (taken->sentence.empty()) waits_.emplace();
    } else {
      Refuse(response, 404,
             fmt::format("there is no {:.80} here (expected / or /api/v1/state, cycles, alarms, "
                         "measurements, prediction, live, picture, events, actions)",
                         request.path));
    }
    return true;
  }

  bool IsLoggedIn(const httplib::Request& request) {
    return logins_.ActorOf(request.get_header_value("Cookie"), SteadyNow()).user.has_value();
  }

  void SendState(const httplib::Request& request, httplib::Response& response) {
    const CampaignSnapshot snapshot = watch_.Snapshot();
    const Actor actor = logins_.ActorOf(request.get_header_value("Cookie"), SteadyNow());
    nlohmann::json state = StateJson(snapshot, Now());
    state["token"] = desk_.Token(snapshot, actor);
    state["has_users"] = actor.knows_users;
    state["user"] = actor.user ? UserJson(*actor.user) : nlohmann::json();
    state["zone"] = zone_;
    state["has_predictor"] = questions_.has_predictor();
    state["events"] = nlohmann::json::array();
    for (const Event& event : snapshot.progress.events) state["events"].push_back(EventJson(event));
    response.status = 200;
    response.set_content(JsonText(state) + "\n", kJson);
  }

  std::optional<PageQuestions::Taken> Ask(const httplib::Request& request) {
    const auto answer = [this, client = caller_.id](int status, std::string_view type,
                                                    const std::string& body) {
      Finish(client, status, body, {}, type);
    };
    return questions_.Ask(request.path, request.params, watch_.Snapshot(), answer);
  }

  // From another thread.
  void Finish(ClientId client, int status, const std::string& body, const HttpHeaders& more = {},
              std::string_view type = kJson) {
    {
      const std::lock_guard lock(mutex_);
      finished_.push_back({client, HttpAnswer(status, type, body, more), true});
    }
    Wake();
  }

  void Wake() {
    const std::lock_guard lock(mutex_);
    if (server_ != nullptr) server_->Wake();
  }

  void OpenStream(const httplib::Request& request, httplib::Response& response) {
    if (viewers_.count() >= kMostStreams) {
      return Refuse(response, 503,
                    fmt::format("{} viewers look on already (expected: one that closes the page; quick stop "
                                "works without a stream)",
                                kMostStreams));
    }
    const WatchedCampaign newest = watch_.Newest();
    const std::int64_t last_seen = LastEventId(request.get_header_value("Last-Event-ID"));
    const Actor actor = logins_.ActorOf(request.get_header_value("Cookie"), SteadyNow());
    viewers_.Add(caller_.id, newest.snapshot.last_event, actor.session);
    waits_ = EventStreamHead() + "retry: 1000\n\n" + JournalFrames(newest.events, last_seen) +
             EventFrame("state", JsonText(StateJson(newest.snapshot, Now())));
  }

  void TakeAction(const httplib::Request& request, httplib::Response& response) {
    const CampaignSnapshot snapshot = watch_.Snapshot();
    const int process = CampaignLock::Holder(folder_);
    if (process > 0 && process != snapshot.progress.process) {
      return Refuse(
          response, 409,
          "the campaign has just been started again; nothing was done, look at the page again before "
          "you act");
    }
    const Actor actor = logins_.Acting(request.get_header_value("Cookie"), SteadyNow());
    const auto answer =
        desk_.Take(request.body, snapshot, actor, [this, client = caller_.id](const ActionAnswer& done) {
          Finish(client, done.status, JsonText(done.body) + "\n");
        });
    if (!answer) {
      waits_.emplace();
      return;
    }
    response.status = answer->status;
    response.set_content(JsonText(answer->body) + "\n", kJson);
  }

  void LogIn(const httplib::Request& request, httplib::Response& response) {
    const auto answer = logins_.LogIn(
        request.body, caller_.address, SteadyNow(), [this, client = caller_.id](const LoginAnswer& done) {
          Finish(client, done.status, JsonText(done.body) + "\n", HeadersOf(done));
        });
    if (!answer) {
      waits_.emplace();
      return;
    }
    Send(response, *answer);
  }

  void LogOut(const httplib::Request& request, httplib::Response& response) {
    Send(response, logins_.LogOut(request.get_header_value("Cookie")));
  }

  static void Send(httplib::Response& response, const LoginAnswer& answer) {
    response.status = answer.status;
    for (const auto& [name, value] : HeadersOf(answer)) response.set_header(name, value);
    response.set_content(JsonText(answer.body) + "\n", kJson);
  }

  static Time SteadyNow() { return std::chrono::steady_clock::now(); }

  const CampaignFolder folder_;
  const std::string_view scheme_;
  const PageGate gate_;
  const std::string zone_{TimeZone()};
  Caller caller_;                     // whose request is answered
  std::optional<std::string> waits_;  // what that one gets at once, where more will follow
  Viewers viewers_;
  std::uint64_t version_{};
  Time heartbeat_due_{};
  std::mutex mutex_;  // of the two below
  TcpServer* server_{};
  std::vector<Delivery> finished_;
  // Their threads call this object: they end before the rest of it does.
  CampaignWatch watch_;
  Logins logins_;
  ActionDesk desk_;
  PageQuestions questions_;
};

PageServer::PageServer(const PageSettings& settings)
    : pages_(std::make_unique<Pages>(settings)),
      server_(std::make_unique<TcpServer>("the page",
                                          ListenSettings{.address = settings.address,
                                                         .port = settings.port,
                                                         .connections = kMostConnections,
                                                         .of_one_network = pages_->MostOfOneNetwork(),
                                                         .idle_after_ms = kIdleAfter_ms,
                                                         .tls = settings.tls},
                                          *pages_, kLimits)) {
  pages_->Begin(*server_);
}

PageServer::~PageServer() {
  pages_->End();
  server_.reset();
}

int PageServer::port() const { return server_->port(); }

}  // namespace strainwave::bench
