// SPDX-License-Identifier: Apache-2.0
#include "bench/central/fleet_server.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "bench/central/away_server.h"
#include "bench/central/fleet_files.h"
#include "bench/central/fleet_view.h"
#include "bench/central/schema.h"
#include "bench/central/server_columns.h"
#include "bench/errors/bench_error.h"
#include "bench/escaped.h"
#include "bench/page/http_text.h"
#include "bench/page/page_gate.h"
#include "bench/serving/http_exchange.h"
#include "bench/serving/worker.h"

namespace strainwave::bench {
namespace {

constexpr const char* kFleetJson = "application/json";
constexpr std::size_t kLongestRequest_bytes = 8192;
constexpr std::size_t kMostWaiting = 100;
constexpr std::chrono::seconds kFresh{1};
constexpr ServerLimits kFleetLimits{.longest_request_bytes = kLongestRequest_bytes,
                                    .request_within = std::chrono::seconds(2),
                                    .answer_within = std::chrono::seconds(10),
                                    .most_unsent_bytes = 1 << 20,
                                    .lingers = true};

std::string ValueOf(const httplib::Params& parameters, const std::string& name) {
  const auto found = parameters.find(name);
  return found == parameters.end() ? "" : found->second;
}

// PostgreSQL has no text that is none, and would be asked in vain.
void DemandTexts(const httplib::Params& parameters) {
  for (const auto& [name, value] : parameters) {
    if (ServerText(name) != name || ServerText(value) != value)
      Refuse(Escaped(name), "is no text", "UTF-8 without the character zero");
  }
}

nlohmann::json AnswerOf(Server& server, const std::string& path, const httplib::Params& parameters) {
  DemandTexts(parameters);
  if (path == "/api/v1/quantities") return QuantitiesJson(server);
  if (path == "/api/v1/comparison") {
    return ComparisonJson(server, ValueOf(parameters, "quantity"),
                          ParseCampaignQuery(ValueOf(parameters, "query")));
  }
  BenchesAsked asked{.find = ValueOf(parameters, "find"), .state = ValueOf(parameters, "state")};
  const std::string from = ValueOf(parameters, "from");
  const bool is_number =
      from.size() <= 7 && std::ranges::all_of(from, [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number) Refuse("from", fmt::format("'{:.20}' is no number of a row", from), "0 or more");
  asked.from = from.empty() ? 0 : std::stoi(from);
  return BenchesJson(server, asked);
}

bool IsQuestion(const std::string& path) {
  return path == "/api/v1/benches" || path == "/api/v1/comparison" || path == "/api/v1/quantities";
}

const StaticFile* FindFleetFile(const std::string& path) {
  // The style and the icon are those of a campaign's page.
  if (path == "/page.css" || path == "/icon.svg" || path == "/format.mjs") return FindStaticFile(path);
  for (const StaticFile& file : FleetFiles()) {
    if (file.path == path) return &file;
  }
  return nullptr;
}

}  // namespace

// Called from the server's thread alone, but for what the worker's does.
class FleetServer::FleetPages : public httplib::Server, public RequestProtocol {
 public:
  explicit FleetPages(FleetSettings settings)
      : settings_(std::move(settings)),
        gate_("127.0.0.1", {}),
        away_(settings_.first_wait),
        worker_(kMostWaiting, Worker::AtEnd::kDrop) {
    set_default_headers({AnswerHeaders().begin(), AnswerHeaders().end()});
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      Route(request, response);
      return HandlerResponse::Handled;
    });
  }

  void Begin(TcpServer& server) {
    const std::lock_guard lock(mutex_);
    tcp_ = &server;
  }
  void End() {
    ends_ = true;
    const std::lock_guard lock(mutex_);
    tcp_ = nullptr;
  }

  std::optional<std::size_t> LengthOf(std::string_view received) override {
    const auto head = HeadOf(received);
    return head ? std::optional(head->bytes) : std::nullopt;
  }

  Reply Answer(std::string_view request, const Caller& caller) override {
    caller_ = caller;
    waits_ = false;
    HttpExchange exchange(request);
    bool closed = false;
    try {
      process_request(exchange, true, closed,
                      [](httplib::Request& asked) { asked.headers.erase("Accept-Encoding"); });
    } catch (const std::exception&) {
      return {HttpAnswer(400, kFleetJson, ErrorJson("the request cannot be read (expected HTTP/1.1)")), true};
    }
    if (waits_) return {.bytes = {}, .waits = true};
    return {.bytes = exchange.answer(), .closes = true};
  }

  std::vector<Delivery> Deliveries(Time now) override {
    const std::lock_guard lock(mutex_);
    std::erase_if(waiting_, [&](const auto& one) {
      if (now - one.second < settings_.answer_within) return false;
      const std::string words = fmt::format(
          "{}: error: no answer for {:.3g} s (expected one in time; it is waited for, and asked again)",
          ShownConninfo(settings_.conninfo), std::chrono::duration<double>(settings_.answer_within).count());
      away_.Overdue(words);
      finished_.push_back({one.first, HttpAnswer(503, kFleetJson, ErrorJson(words)), true});
      return true;
    });
    return std::exchange(finished_, {});
  }
  void Left(ClientId client) override {
    const std::lock_guard lock(mutex_);
    waiting_.erase(client);
  }

  std::string LastWords(Refusal) override {
    return HttpAnswer(408, kFleetJson, ErrorJson("the request is too long, or was not whole in time"));
  }

 private:
  struct Kept {
    Time asked;
    std::string body;
  };

  static void Refused(httplib::Response& response, int status, std::string_view sentence) {
    response.status = status;
    response.set_content(ErrorJson(sentence), kFleetJson);
  }

  void Route(const httplib::Request& request, httplib::Response& response) {
    if (const auto wrong = gate_.WrongHost(request.get_header_value("Host"), caller_.own_address)) {
      Refused(response, 403, *wrong);
    } else if (request.method != "GET" && request.method != "HEAD") {
      Refused(response, 405, fmt::format("{:.20} is not done here (expected GET)", request.method));
    } else if (const StaticFile* file = FindFleetFile(request.path)) {
      response.status = 200;
      response.set_content(file->bytes.data(), file->bytes.size(), std::string(file->type));
    } else if (!IsQuestion(request.path)) {
      Refused(response, 404,
              fmt::format("there is no {:.80} here (expected / or /api/v1/benches, comparison, quantities)",
                          request.path));
    } else {
      Wait(request, response);
    }
  }

  void Wait(const httplib::Request& request, httplib::Response& response) {
    const Time now = std::chrono::steady_clock::now();
    {
      const std::lock_guard lock(mutex_);
      if (const auto why = away_.WhyNot(now)) return Refused(response, 503, *why);
      waiting_[caller_.id] = now;
    }
    waits_ = worker_.Post([this, client = caller_.id, target = request.target, path = request.path,
                           parameters = request.params] { AskServer(client, target, path, parameters); });
    if (waits_) return;
    Left(caller_.id);
    Refused(response, 503, "too many ask at once (expected: ask again later)");
  }

  // From here on in the worker's thread.
  void AskServer(ClientId client, const std::string& target, const std::string& path,
                 const httplib::Params& parameters) {
    const Time now = std::chrono::steady_clock::now();
    std::erase_if(kept_, [&](const auto& one) { return now - one.second.asked > kFresh; });
    if (const auto found = kept_.find(target); found != kept_.end())
      return Finish(client, 200, found->second.body);
    {
      const std::lock_guard lock(mutex_);
      // It has left, or is answered already.
      if (!waiting_.contains(client)) return;
      if (const auto why = away_.WhyNot(now)) return FinishLocked(client, 503, ErrorJson(*why));
      away_.Ask();
    }
    try {
      Connect();
      const std::string body = JsonText(AnswerOf(*postgres_, path, parameters)) + "\n";
      kept_[target] = {now, body};
      Answered(client, 200, body);
    } catch (const ServerError& error) {
      postgres_.reset();
      error.kind() == ServerError::Kind::kAway ? Failed(client, error.what())
                                               : Answered(client, 503, ErrorJson(error.what()));
    } catch (const NotConnected& error) {
      Failed(client, error.what());
    } catch (const BenchError& error) {
      Answered(client, 400, ErrorJson(error.what()));
    } catch (const std::exception& error) {
      postgres_.reset();
      Answered(client, 500, ErrorJson(error.what()));
    }
  }

  // A server that refuses this role, or has other tables, is as good as away: somebody has to put it right.
  struct NotConnected : std::runtime_error {
    using std::runtime_error::runtime_error;
  };
  void Connect() {
    if (postgres_) return;
    try {
      auto server = std::make_unique<bench::Server>(
          settings_.conninfo, [this] { return ends_.load(); }, settings_.patience);
      DemandSchema(*server);
      postgres_ = std::move(server);
    } catch (const BenchError& error) {
      throw NotConnected(error.what());
    }
  }

  void Answered(ClientId client, int status, const std::string& body) {
    const std::lock_guard lock(mutex_);
    away_.Answered();
    FinishLocked(client, status, body);
  }
  void Failed(ClientId client, const std::string& why) {
    const std::lock_guard lock(mutex_);
    away_.Failed(why, std::chrono::steady_clock::now());
    FinishLocked(client, 503, ErrorJson(why));
  }
  void Finish(ClientId client, int status, const std::string& body) {
    const std::lock_guard lock(mutex_);
    FinishLocked(client, status, body);
  }
  void FinishLocked(ClientId client, int status, const std::string& body) {
    if (waiting_.erase(client) == 0) return;
    finished_.push_back({client, HttpAnswer(status, kFleetJson, body), true});
    if (tcp_ != nullptr) tcp_->Wake();
  }

  const FleetSettings settings_;
  const PageGate gate_;
  Caller caller_;  // whose request is answered
  bool waits_{};
  std::mutex mutex_;  // of the four below
  TcpServer* tcp_{};
  std::map<ClientId, Time> waiting_;  // since when
  std::vector<Delivery> finished_;
  AwayServer away_;
  std::atomic<bool> ends_{};
  // Of the worker's thread.
  std::unique_ptr<bench::Server> postgres_;
  std::map<std::string, Kept> kept_;
  Worker worker_;  // its thread calls this object: it ends before the rest does
};

FleetServer::FleetServer(const FleetSettings& settings)
    : pages_(std::make_unique<FleetPages>(settings)),
      server_(std::make_unique<TcpServer>(
          "the page", ListenSettings{.address = "127.0.0.1", .port = settings.port, .connections = 300},
          *pages_, kFleetLimits)) {
  pages_->Begin(*server_);
}

FleetServer::~FleetServer() {
  pages_->End();
  server_.reset();
}

int FleetServer::port() const { return server_->port(); }

}  // namespace strainwave::bench
