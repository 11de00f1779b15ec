// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/prometheus_server.h"

#include <exception>

#include <httplib.h>

#include "bench/monitor/prometheus_text.h"
#include "bench/serving/http_exchange.h"

namespace strainwave::bench {

// The library reads requests and makes answers. It does not listen: it would give every client a thread for
// as long as that one says nothing.
class PrometheusServer::Pages : public httplib::Server, public RequestProtocol {
 public:
  explicit Pages(const Board& board) {
    Get("/metrics", [&board](const httplib::Request&, httplib::Response& response) {
      response.set_content(PrometheusText(board.State(), board.frame(), board.NowMilliseconds()),
                           "text/plain; version=0.0.4; charset=utf-8");
    });
  }

  std::optional<std::size_t> LengthOf(std::string_view received) override {
    constexpr std::string_view kEnd = "\r\n\r\n";
    const std::size_t end = received.find(kEnd);
    return end == std::string_view::npos ? std::nullopt : std::optional(end + kEnd.size());
  }

  Reply Answer(std::string_view request, const Caller&) override {
    HttpExchange exchange(request);
    bool closed = false;
    try {
      process_request(exchange, true, closed, nullptr);
    } catch (const std::exception&) {
      // Whatever a stranger sends that the library does not bear ends that connection and nothing else.
      return {.bytes = {}, .closes = true};
    }
    return {.bytes = exchange.answer(), .closes = true};
  }
};

PrometheusServer::PrometheusServer(const ListenSettings& settings, const Board& board)
    : pages_(std::make_unique<Pages>(board)), server_("prometheus", settings, *pages_) {}

PrometheusServer::~PrometheusServer() = default;

}  // namespace strainwave::bench
