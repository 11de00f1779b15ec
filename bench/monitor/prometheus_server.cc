// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/prometheus_server.h"

#include <cerrno>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <httplib.h>

#include "bench/monitor/prometheus_text.h"

namespace strainwave::bench {

struct PrometheusServer::Server {
  httplib::Server http;
  std::thread thread;
};

PrometheusServer::PrometheusServer(const ListenSettings& settings, const Board& board)
    : server_(std::make_unique<Server>()) {
  server_->http.Get("/metrics", [&board](const httplib::Request&, httplib::Response& response) {
    response.set_content(PrometheusText(board.State(), board.frame(), board.NowMilliseconds()),
                         "text/plain; version=0.0.4; charset=utf-8");
  });
  // Two are enough, and one that says nothing does not keep the other waiting.
  server_->http.new_task_queue = [] { return new httplib::ThreadPool(2); };
  server_->http.set_read_timeout(5);
  server_->http.set_keep_alive_max_count(1);
  server_->http.set_payload_max_length(4096);
  if (settings.port == 0) {
    port_ = server_->http.bind_to_any_port(settings.address);
  } else if (server_->http.bind_to_port(settings.address, settings.port)) {
    port_ = settings.port;
  }
  if (port_ <= 0) {
    throw std::system_error(
        errno, std::generic_category(),
        fmt::format("prometheus cannot listen on {} port {}", settings.address, settings.port));
  }
  server_->thread = std::thread([http = &server_->http] { http->listen_after_bind(); });
}

PrometheusServer::~PrometheusServer() {
  // A server that was told to stop before it runs would run for ever.
  while (!server_->http.is_running()) std::this_thread::yield();
  server_->http.stop();
  server_->thread.join();
}

}  // namespace strainwave::bench
