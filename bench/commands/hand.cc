// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/hand.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <utility>

#include "bench/devices/wake.h"

namespace strainwave::bench {

Hand::Hand(DeadMan& dead_man, const BenchClock& clock, std::function<void()> ended)
    : dead_man_(dead_man),
      clock_(clock),
      ended_(std::move(ended)),
      is_terminal_(::tcgetattr(STDIN_FILENO, &before_) == 0) {
  if (is_terminal_) {
    // Key by key, and not shown; Ctrl-C stays what it is.
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  thread_ = std::thread([this] { Listen(); });
}

Hand::~Hand() {
  stop_ = true;
  thread_.join();
  if (is_terminal_) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
}

void Hand::Listen() {
  constexpr std::chrono::milliseconds kLook{50};
  std::array<char, 64> keys;
  while (!stop_) {
    if (WaitReadable(STDIN_FILENO, nullptr, kLook) != Waited::kReadable) continue;
    const ssize_t got = ::read(STDIN_FILENO, keys.data(), keys.size());
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    bool ends = got <= 0;
    for (ssize_t i = 0; i < got; ++i) {
      const char key = keys[static_cast<std::size_t>(i)];
      ends = ends || key == 'q';
      if (key == ' ' || key == '\n') {
        dead_man_.Hold(clock_.Now());
      } else {
        dead_man_.Release();
      }
    }
    if (!ends) continue;
    dead_man_.Release();
    ended_();
    return;
  }
}

}  // namespace strainwave::bench
