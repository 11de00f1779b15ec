// SPDX-License-Identifier: Apache-2.0
// waiting_messages windows|notices FILE COUNT: an outbox of a monitor, or of a watch, that gets COUNT
// messages more and gives some of them to a receiver. Each line says what has become of one, as soon as it is
// so:
//
//   holds N ...     what waits when it is opened
//   last N          the newest that was ever put in, by the file
//   birth N         number of the next connection, when it is opened; and kept, since the call has returned
//   shown N         put in, kept on the disk, and then told to people
//   received N      the receiver has it, and the outbox does not know yet
//   removed N       kept on the disk that it is received
//   ended           of this one; without it, the power has gone
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/monitor/outbox.h"
#include "bench/monitor/sparkplug_metrics.h"
#include "bench/notices/notice_file.h"

namespace strainwave::bench {
namespace {

// A receiver that is behind: as many are under way at once.
constexpr int kUnderWay = 2;

// What was said before the power goes is said.
void Say(const std::string& line) {
  std::puts(line.c_str());
  std::fflush(stdout);
}

std::string ValueOf(std::int64_t number) { return std::string(300, static_cast<char>('a' + number % 26)); }

std::vector<protocols::SparkplugMetric> Window(std::int64_t number) {
  return {{.name = std::string(kWindowMetric), .value = number}, {.name = "Value", .value = ValueOf(number)}};
}

std::int64_t NumberOf(const std::vector<protocols::SparkplugMetric>& window) {
  const auto number = std::get<std::int64_t>(window.at(0).value);
  if (std::get<std::string>(window.at(1).value) != ValueOf(number)) throw std::runtime_error("another value");
  return number;
}

void SayHeld(const std::vector<std::int64_t>& numbers, std::int64_t last) {
  Say(fmt::format("holds {}", fmt::join(numbers, " ")));
  Say(fmt::format("last {}", last));
}

// As a monitor does: a birth at each start; windows that are pushed, then shown; up to so many under way.
void KeepWindows(const std::string& file, int count) {
  auto store = std::make_unique<OutboxStore>(file);
  const std::int64_t last = store->last_window();
  int birth = store->next_birth();
  Say(fmt::format("birth {}", birth));
  Outbox outbox({}, std::move(store));
  std::vector<std::int64_t> held;
  for (std::size_t place = 0; const auto* const each = outbox.At(place); ++place)
    held.push_back(NumberOf(*each));
  SayHeld(held, last);
  const auto tell_trouble = [&] {
    if (!outbox.trouble().empty()) Say("trouble " + outbox.trouble());
    return !outbox.trouble().empty();
  };
  if (count > 0) {
    outbox.KeepNextBirth(++birth);
    if (!tell_trouble()) Say(fmt::format("birth {}", birth));
  }
  int ticket = 0;
  std::vector<std::int64_t> under_way;
  for (std::int64_t number = last + 1; number <= last + count; ++number) {
    outbox.Push(Window(number), true);
    if (!tell_trouble()) Say(fmt::format("shown {}", number));
    while (under_way.size() < kUnderWay && outbox.Next() != nullptr) {
      under_way.push_back(NumberOf(*outbox.Next()));
      outbox.Sent(ticket + static_cast<int>(under_way.size()));
    }
    if (number % 3 == 0) continue;
    Say(fmt::format("received {}", under_way.front()));
    outbox.Acknowledge(++ticket);
    if (!tell_trouble()) Say(fmt::format("removed {}", under_way.front()));
    under_way.erase(under_way.begin());
  }
}

// As a watch does: what is due is kept before it is sent, and that it was sent before the next.
void KeepNotices(const std::string& file, int count) {
  std::string trouble;
  NoticeState state = ReadNoticeFile(file, trouble);
  if (!trouble.empty()) throw std::runtime_error(trouble);
  UseChannels(state.outbox, {"webhook"});
  std::vector<std::int64_t> held;
  for (const WaitingNotice& waiting : state.outbox.waiting) held.push_back(std::stoll(waiting.notice.id));
  SayHeld(held, state.memory.last_number);
  const auto keep = [&] {
    try {
      WriteNoticeFile(file, state);
      return true;
    } catch (const std::exception& error) {
      Say(fmt::format("trouble {}", error.what()));
      return false;
    }
  };
  const Moment now = Now();
  for (int i = 0; i < count; ++i) {
    const std::int64_t number = ++state.memory.last_number;
    Notice notice;
    notice.id = std::to_string(number);
    notice.text = ValueOf(number);
    Put(state.outbox, {notice}, now);
    if (keep()) Say(fmt::format("shown {}", number));
    if (number % 3 == 0) continue;
    const std::string next = NextFor(state.outbox, "webhook", now)->id;
    Say("received " + next);
    Delivered(state.outbox, "webhook", next);
    if (keep()) Say("removed " + next);
  }
}

}  // namespace
}  // namespace strainwave::bench

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  try {
    const auto keep =
        std::string(argv[1]) == "windows" ? strainwave::bench::KeepWindows : strainwave::bench::KeepNotices;
    keep(argv[2], std::stoi(argv[3]));
  } catch (const std::exception& error) {
    std::printf("%s\n", error.what());
    return 3;
  }
  std::puts("ended");
  return 0;
}
