// SPDX-License-Identifier: Apache-2.0
#include "bench/page/http_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace strainwave::bench {
namespace {

constexpr std::string_view kLineEnd = "\r\n";
constexpr std::string_view kHeadEnd = "\r\n\r\n";

bool IsName(std::string_view text, std::string_view lower_case) {
  return std::ranges::equal(text, lower_case,
                            [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::string_view Reason(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 408:
      return "Request Timeout";
    case 409:
      return "Conflict";
    case 411:
      return "Length Required";
    case 413:
      return "Payload Too Large";
    case 415:
      return "Unsupported Media Type";
    case 429:
      return "Too Many Requests";
    case 431:
      return "Request Header Fields Too Large";
    case 500:
      return "Internal Server Error";
    case 503:
      return "Service Unavailable";
    default:
      return "Error";
  }
}

std::string LinesOf(const HttpHeaders& headers) {
  std::string lines;
  for (const auto& [name, value] : headers) lines += fmt::format("{}: {}\r\n", name, value);
  return lines;
}

}  // namespace

std::optional<RequestHead> HeadOf(std::string_view received) {
  const std::size_t end = received.find(kHeadEnd);
  if (end == std::string_view::npos) return std::nullopt;
  RequestHead head{.bytes = end + kHeadEnd.size()};
  std::string_view lines = received.substr(0, end + kLineEnd.size());
  std::optional<std::size_t> length;
  while (!lines.empty()) {
    const std::size_t line_end = lines.find(kLineEnd);
    const std::string_view line = lines.substr(0, line_end);
    lines.remove_prefix(line_end + kLineEnd.size());
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) continue;
    const std::string_view name = Trimmed(line.substr(0, colon));
    const std::string_view value = Trimmed(line.substr(colon + 1));
    if (IsName(name, "transfer-encoding")) head.is_chunked = true;
    if (!IsName(name, "content-length")) continue;
    std::size_t number{};
    const auto [last, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    const bool is_number = error == std::errc() && last == value.data() + value.size();
    head.is_ambiguous = head.is_ambiguous || !is_number || (length && *length != number);
    length = number;
  }
  head.body_bytes = length.value_or(0);
  return head;
}

const HttpHeaders& AnswerHeaders() {
  static const HttpHeaders headers{
      {"Content-Security-Policy",
       "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
       "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cache-Control", "no-store"}};
  return headers;
}

std::string HttpAnswer(int status, std::string_view type, std::string_view body, const HttpHeaders& more) {
  return fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n{}{}\r\n{}", status,
      Reason(status), type, body.size(), LinesOf(AnswerHeaders()), LinesOf(more), body);
}

std::string EventStreamHead() {
  return fmt::format("HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nConnection: close\r\n{}\r\n",
                     LinesOf(AnswerHeaders()));
}

std::string JsonText(const nlohmann::json& document) {
  return document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string ErrorJson(std::string_view sentence) { return JsonText({{"error", sentence}}) + "\n"; }

bool IsOwnOrigin(std::string_view origin, std::string_view scheme, std::string_view host) {
  return origin.empty() || (origin.starts_with(scheme) && origin.substr(scheme.size()) == host);
}

}  // namespace strainwave::bench
