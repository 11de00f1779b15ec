// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <httplib.h>

#include "bench/serving/request_text.h"

namespace strainwave::bench {

/// A request that is there already, and the answer to it, for a server of cpp-httplib that does not listen
/// (docs/decisions/0012-one-thread-per-server.md). It asks for no parts of an answer (request_text.h).
class HttpExchange : public httplib::Stream {
 public:
  explicit HttpExchange(std::string_view request) : text_(WithoutRanges(request)), request_(text_) {}

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
  std::string text_;
  std::string_view request_;  // what of it has not been read
  std::string answer_;
};

}  // namespace strainwave::bench
