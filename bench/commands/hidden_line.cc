// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/hidden_line.h"

#include <poll.h>
#include <sys/signalfd.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <iostream>
#include <system_error>

#include "bench/commands/output.h"

namespace strainwave::bench {
namespace {

// Those that a terminal or a person sends.
constexpr std::array kTaken{SIGINT, SIGQUIT, SIGTERM, SIGHUP, SIGTSTP};

// Holds the signals back, for a descriptor to say which came.
class HeldSignals {
 public:
  HeldSignals() {
    ::sigemptyset(&taken_);
    for (const int signal : kTaken) ::sigaddset(&taken_, signal);
    ::pthread_sigmask(SIG_BLOCK, &taken_, &before_);
    descriptor_ = ::signalfd(-1, &taken_, SFD_CLOEXEC | SFD_NONBLOCK);
    if (descriptor_ >= 0) return;
    const int error = errno;
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    throw std::system_error(error, std::generic_category(), "signalfd");
  }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  ~HeldSignals() {
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    ::close(descriptor_);
  }

  int descriptor() const { return descriptor_; }
  // 0: none.
  int Take() const {
    signalfd_siginfo came{};
    return ::read(descriptor_, &came, sizeof came) == sizeof came ? static_cast<int>(came.ssi_signo) : 0;
  }

 private:
  sigset_t taken_{};
  sigset_t before_{};
  int descriptor_{-1};
};

class HiddenTerminal {
 public:
  HiddenTerminal() {
    is_hidden_ = ::tcgetattr(STDIN_FILENO, &before_) == 0;
    termios hidden = before_;
    hidden.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    if (is_hidden_) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &hidden);
  }
  HiddenTerminal(const HiddenTerminal&) = delete;
  HiddenTerminal& operator=(const HiddenTerminal&) = delete;
  // What was typed and not read would be shown to whoever reads next.
  ~HiddenTerminal() {
    if (is_hidden_) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
  }

 private:
  termios before_{};
  bool is_hidden_{};
};

enum class Ended { kLine, kInput, kSignal };
struct Typed {
  Ended ended{};
  std::string line{};
  int signal{};
};

Typed ReadUnseen(const std::string& question) {
  const HeldSignals signals;
  const HiddenTerminal hidden;
  ToStderr("{}", question);
  Typed typed;
  while (true) {
    std::array<pollfd, 2> waits{{{STDIN_FILENO, POLLIN, 0}, {signals.descriptor(), POLLIN, 0}}};
    if (::poll(waits.data(), waits.size(), -1) < 0 && errno != EINTR) {
      throw std::system_error(errno, std::generic_category(), "poll");
    }
    typed.signal = signals.Take();
    if (typed.signal != 0) return {.ended = Ended::kSignal, .line = {}, .signal = typed.signal};
    if (waits[0].revents == 0) continue;
    char key = 0;
    const ssize_t got = ::read(STDIN_FILENO, &key, 1);
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got <= 0) typed.ended = Ended::kInput;
    if (got <= 0 || key == '\n') return typed;
    typed.line += key;
  }
}

}  // namespace

bool IsAtTerminal() { return ::isatty(STDIN_FILENO) == 1; }

std::optional<std::string> ReadHiddenLine(const std::string& question) {
  if (!IsAtTerminal()) {
    std::string line;
    return std::getline(std::cin, line) ? std::optional(line) : std::nullopt;
  }
  while (true) {
    Typed typed = ReadUnseen(question);
    ToStderr("\n");
    if (typed.ended == Ended::kLine) return std::move(typed.line);
    if (typed.ended == Ended::kInput) return std::nullopt;
    // The terminal is as it was, and the signal is at its default: it ends the program here, or stops it for
    // a while.
    std::raise(typed.signal);
  }
}

}  // namespace strainwave::bench
