// SPDX-License-Identifier: Apache-2.0
// Any bytes from a browser: heads, and cpp-httplib's reading of whole requests as the servers of the program
// call it; then the parts of a request that the page reads itself.
#include <httplib.h>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>

#include "bench/page/cycles.h"
#include "bench/page/event_stream.h"
#include "bench/page/http_text.h"
#include "bench/page/page_gate.h"
#include "bench/serving/http_exchange.h"

using namespace strainwave::bench;

namespace {

// Looks at each request as the page does, and answers it with little.
class AnyServer : public httplib::Server {
 public:
  using httplib::Server::process_request;
  AnyServer() {
    set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
      const PageGate gate("192.0.2.7", {"bench"});
      (void)gate.WrongHost(request.get_header_value("Host"), "192.0.2.7");
      (void)gate.IsGuarded(request.path);
      (void)IsOwnOrigin(request.get_header_value("Origin"), "http://", request.get_header_value("Host"));
      if (LastEventId(request.get_header_value("Last-Event-ID")) < 0) std::abort();
      try {
        const CyclesQuery query = ParseCyclesQuery(request.params);
        if (query.points < 1 || query.from < 0) std::abort();
      } catch (const std::invalid_argument&) {
      }
      if (request.method == "POST" && !request.has_header("Content-Encoding"))
        return HandlerResponse::Unhandled;
      response.set_content(ErrorJson(request.path.substr(0, 80)), "application/json");
      return HandlerResponse::Handled;
    });
    Post("/api/v1/actions", [](const httplib::Request& request, httplib::Response& response) {
      response.set_content(JsonText({{"bytes", request.body.size()}}), "application/json");
    });
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view received(reinterpret_cast<const char*>(data), size);
  const auto head = HeadOf(received);
  if (!head) return 0;
  if (head->bytes > received.size()) std::abort();
  static AnyServer server;
  HttpExchange exchange(received);
  bool closed = false;
  try {
    server.process_request(exchange, true, closed, nullptr);
  } catch (const std::exception&) {
    return 0;  // answered with 400 by both servers
  }
  constexpr std::size_t kMostAnswer_bytes = 4096;
  if (exchange.answer().size() > kMostAnswer_bytes) std::abort();
  return 0;
}
