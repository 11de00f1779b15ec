// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/prometheus_server.h"

#include <algorithm>
#include <exception>

#include <httplib.h>

#include "bench/monitor/prometheus_text.h"

namespace strainwave::bench {
namespace {

// A request that is there already, and the answer to it.
class Exchange : public httplib::Stream {
 public:
  explicit Exchange(std::string_view request) : request_(request) {}

  const std::string& answer() const { return answer_; }

  bool is_readable() const override { return !request_.empty(); }
  bool is_writable() const override { return true; }
  ssize_t read(char* bytes, std::size_t most) override {
    const std::size_t count = request_.copy(bytes, most);
    request_.remove_prefix(count);
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* bytes, std::size_t count) override {
    answer_.append(bytes, count);
    return static_cast<ssize_t>(count);
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return INVALID_SOCKET; }

 private:
  std::string_view request_;
  std::string answer_;
};

}  // namespace

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

  Reply Answer(std::string_view request) override {
    Exchange exchange(request);
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
