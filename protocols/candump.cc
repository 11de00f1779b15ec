// SPDX-License-Identifier: Apache-2.0
#include "protocols/candump.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

namespace strainwave::protocols {
namespace {

constexpr std::uint32_t kErrorFlag = 0x20000000;  // of an id as Linux keeps it
constexpr std::uint32_t kMostStandardId = 0x7FF;
constexpr std::uint32_t kMostExtendedId = 0x1FFFFFFF;
constexpr std::size_t kMostNameLength = 15;  // of a network interface under Linux

struct Finding {
  std::size_t at;  // in the line
  std::string what;
};

bool IsHex(char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'F') || (c >= 'a' && c <= 'f'); }

std::size_t CountHex(std::string_view text) {
  return static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), IsHex) - text.begin());
}

template <typename Number>
std::optional<Number> NumberOf(std::string_view digits, int base) {
  Number number{};
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number, base);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return number;
}

// One line, taken from the front; throws the first Finding.
class LineReader {
 public:
  explicit LineReader(std::string_view line) : line_(line) {}

  LoggedFrame Read() {
    LoggedFrame logged;
    logged.time = Time();
    if (!Take(' ')) Fail("no space after the time");
    logged.interface = Interface();
    logged.frame = Id();
    if (!Take('#')) Fail("no '#' after the id");
    if (Next() == '#') Fail("a CAN FD frame (expected a classical one: a single '#')");
    Data(logged.frame);
    if (at_ != line_.size()) Fail("text after the frame (expected the end of the line)");
    return logged;
  }

 private:
  char Next() const { return at_ < line_.size() ? line_[at_] : '\0'; }
  bool Take(char c) {
    if (Next() != c) return false;
    ++at_;
    return true;
  }
  [[noreturn]] void Fail(std::string what) const { throw Finding{at_, std::move(what)}; }

  std::string_view Digits() {
    const std::size_t begin = at_;
    while (Next() >= '0' && Next() <= '9') ++at_;
    return line_.substr(begin, at_ - begin);
  }

  std::chrono::microseconds Time() {
    constexpr std::string_view kForm = "(expected '(SECONDS.MICROSECONDS)' with six decimals)";
    constexpr std::int64_t kMostSeconds = 9'000'000'000'000;  // what microseconds in 64 bits can hold
    const auto fail = [&] { throw Finding{0, fmt::format("not a time {}", kForm)}; };
    if (!Take('(')) fail();
    const std::optional<std::int64_t> seconds = NumberOf<std::int64_t>(Digits(), 10);
    if (!seconds || *seconds > kMostSeconds || !Take('.')) fail();
    const std::string_view decimals = Digits();
    if (decimals.size() != 6 || !Take(')')) fail();
    return std::chrono::seconds(*seconds) + std::chrono::microseconds(*NumberOf<std::int64_t>(decimals, 10));
  }

  std::string Interface() {
    const std::size_t begin = at_;
    const std::size_t end = line_.find(' ', begin);
    if (end == std::string_view::npos || end == begin || end - begin > kMostNameLength) {
      Fail("no name of an interface (expected 1 to 15 characters and a space)");
    }
    at_ = end + 1;
    return std::string(line_.substr(begin, end - begin));
  }

  CanFrame Id() {
    const std::size_t digits = CountHex(line_.substr(at_));
    if (digits != 3 && digits != 8) {
      Fail(fmt::format("an id of {} hexadecimal digits (expected 3, or 8 of an extended or error frame)",
                       digits));
    }
    const std::uint32_t number = *NumberOf<std::uint32_t>(line_.substr(at_, digits), 16);
    CanFrame frame;
    if (digits == 3) {
      if (number > kMostStandardId)
        Fail(fmt::format("id {:X} has more than 11 bits (expected up to 7FF)", number));
      frame.id = number;
    } else if ((number & kErrorFlag) != 0) {
      if ((number & ~kErrorFlag) > kMostExtendedId) {
        Fail(fmt::format("id {:08X} of an error frame (expected 20000000 to 3FFFFFFF)", number));
      }
      frame.error = true;
      frame.id = number & ~kErrorFlag;
    } else {
      if (number > kMostExtendedId)
        Fail(fmt::format("id {:08X} has more than 29 bits (expected up to 1FFFFFFF)", number));
      frame.extended = true;
      frame.id = number;
    }
    at_ += digits;
    return frame;
  }

  void Data(CanFrame& frame) {
    if (Next() == 'R') {
      if (frame.error) Fail("an error frame cannot be a remote one (expected data)");
      ++at_;
      frame.remote = true;
      if (Next() >= '0' && Next() <= '8') frame.length = static_cast<std::uint8_t>(line_[at_++] - '0');
      return;
    }
    const std::size_t digits = CountHex(line_.substr(at_));
    if (digits % 2 != 0 || digits / 2 > frame.data.size()) {
      Fail(fmt::format("{} digits of data (expected two a byte, up to 8 bytes)", digits));
    }
    for (; frame.length < digits / 2; ++frame.length, at_ += 2) {
      frame.data[frame.length] = *NumberOf<std::uint8_t>(line_.substr(at_, 2), 16);
    }
  }

  std::string_view line_;
  std::size_t at_{};
};

std::string Id(const CanFrame& frame) {
  if (frame.error) return fmt::format("{:08X}", frame.id | kErrorFlag);
  return frame.extended ? fmt::format("{:08X}", frame.id) : fmt::format("{:03X}", frame.id);
}

}  // namespace

std::string CandumpLine(const LoggedFrame& logged) {
  const CanFrame& frame = logged.frame;
  const auto seconds = std::chrono::floor<std::chrono::seconds>(logged.time);
  std::string line = fmt::format("({:010}.{:06}) {} {}#", seconds.count(), (logged.time - seconds).count(),
                                 logged.interface, Id(frame));
  if (frame.remote) {
    line += frame.length == 0 ? "R" : fmt::format("R{}", frame.length);
    return line;
  }
  for (std::size_t i = 0; i < frame.length && i < frame.data.size(); ++i) {
    line += fmt::format("{:02X}", frame.data[i]);
  }
  return line;
}

std::vector<LoggedFrame> ParseCandump(std::string_view text, std::string_view file_name) {
  std::vector<LoggedFrame> frames;
  std::string findings;
  for (std::size_t number = 1, begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty()) continue;
    try {
      frames.push_back(LineReader(line).Read());
    } catch (const Finding& finding) {
      findings += fmt::format("{}{}:{}:{}: error: {}", findings.empty() ? "" : "\n", file_name, number,
                              finding.at + 1, finding.what);
    }
  }
  if (!findings.empty()) throw std::runtime_error(findings);
  return frames;
}

}  // namespace strainwave::protocols
