// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/mail_message.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>

namespace strainwave::bench {
namespace {

constexpr std::size_t kMostWord_bytes = 42;  // of an encoded word, which has 75 characters at most
constexpr std::size_t kLine = 76;

bool BeginsCharacter(char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }

// In encoded words, each of whole characters.
std::string EncodedWords(std::string_view text) {
  std::vector<std::string> words;
  while (!text.empty()) {
    std::size_t end = std::min(text.size(), kMostWord_bytes);
    while (end < text.size() && end > 1 && !BeginsCharacter(text[end])) --end;
    words.push_back(fmt::format("=?utf-8?B?{}?=", Base64(text.substr(0, end))));
    text.remove_prefix(end);
  }
  return fmt::format("{}", fmt::join(words, "\r\n "));
}

// "3" of "3@bench.example"
std::string_view HostOf(std::string_view address) { return address.substr(address.find('@') + 1); }

}  // namespace

std::string Base64(std::string_view bytes) {
  // Four characters for three bytes, and a zero that EVP_EncodeBlock writes behind them.
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

std::string MailDate(std::int64_t utc_ms) {
  constexpr std::array kDays{"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  constexpr std::array kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                               "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const std::chrono::sys_time<std::chrono::milliseconds> at{std::chrono::milliseconds(utc_ms)};
  const auto day = std::chrono::floor<std::chrono::days>(at);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss time(std::chrono::floor<std::chrono::seconds>(at - day));
  return fmt::format("{}, {:02} {} {} {:02}:{:02}:{:02} +0000", kDays[std::chrono::weekday(day).c_encoding()],
                     static_cast<unsigned>(date.day()), kMonths[static_cast<unsigned>(date.month()) - 1],
                     static_cast<int>(date.year()), time.hours().count(), time.minutes().count(),
                     time.seconds().count());
}

std::vector<std::string> RecipientsOf(const Notice& notice, const std::vector<std::string>& first,
                                      const std::vector<std::string>& second) {
  std::vector<std::string> all;
  if (notice.audience != Audience::kSecond || second.empty()) all = first;
  if (notice.audience != Audience::kFirst) {
    for (const std::string& address : second) {
      if (std::ranges::find(all, address) == all.end()) all.push_back(address);
    }
  }
  return all;
}

std::string MailMessage(const Notice& notice, const std::string& from, const std::vector<std::string>& to) {
  std::string message = fmt::format(
      "Date: {}\r\nFrom: {}\r\nTo: {}\r\nSubject: {}\r\nMessage-ID: <{}@{}>\r\n"
      "Auto-Submitted: auto-generated\r\nMIME-Version: 1.0\r\nContent-Type: text/plain; charset=utf-8\r\n"
      "Content-Transfer-Encoding: base64\r\n\r\n",
      MailDate(notice.utc_ms), from, fmt::join(to, ",\r\n "), EncodedWords(notice.subject), notice.id,
      HostOf(from));
  const std::string body = Base64(notice.text);
  for (std::size_t at = 0; at < body.size(); at += kLine) message += body.substr(at, kLine) + "\r\n";
  return message;
}

}  // namespace strainwave::bench
