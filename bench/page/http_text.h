// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace strainwave::bench {

using HttpHeaders = std::vector<std::pair<std::string, std::string>>;

/// Of a request, as far as its length needs it.
struct RequestHead {
  std::size_t bytes{};       // of the head, with the empty line at its end
  std::size_t body_bytes{};  // by Content-Length
  bool is_chunked{};         // a body whose length the head does not say
  bool is_ambiguous{};       // two lengths, or one that is no number
};

/// Nothing while the head is not whole.
std::optional<RequestHead> HeadOf(std::string_view received);

/// What every answer of the page carries: no script but the page's own files, nothing from elsewhere, in no
/// other page's frame, kept in no cache.
const HttpHeaders& AnswerHeaders();

/// A whole answer that closes its connection. @param more  headers beside those of every answer.
std::string HttpAnswer(int status, std::string_view type, std::string_view body,
                       const HttpHeaders& more = {});

/// The head of an answer without end, of server-sent events.
std::string EventStreamHead();

/// On one line; a journal may hold any bytes: what is no UTF-8 is replaced.
std::string JsonText(const nlohmann::json& document);

/// {"error": sentence}
std::string ErrorJson(std::string_view sentence);

/// Whether an Origin header, where there is one, is that of the page itself. @param scheme  "https://".
bool IsOwnOrigin(std::string_view origin, std::string_view scheme, std::string_view host);

}  // namespace strainwave::bench
