// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/signals.h"

#include <pthread.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <thread>
#include <utility>

namespace strainwave::bench {
namespace {

// What a campaign is told by. A shell without job control starts what runs in its background with SIGINT
// ignored.
constexpr std::array kAlways{SIGINT, SIGTERM, SIGUSR1, SIGUSR2};
// By default these neither end nor stop a process.
constexpr std::array kHarmless{SIGCHLD, SIGCONT, SIGURG, SIGWINCH};

bool IsOneOf(const auto& signals, int signal) { return std::ranges::find(signals, signal) != signals.end(); }

bool IsAtItsDefault(int signal) {
  struct sigaction now {};
  return sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_DFL;
}

}  // namespace

void ListenToSignals(std::function<void(int signal, pid_t sender)> on_signal) {
  std::signal(SIGTTOU, SIG_IGN);
  std::signal(SIGTTIN, SIG_IGN);
  sigset_t heard;
  sigemptyset(&heard);
  for (int signal = 1; signal <= SIGRTMAX; ++signal) {
    if (IsOneOf(kHarmless, signal)) continue;
    if (IsOneOf(kAlways, signal) || IsAtItsDefault(signal)) sigaddset(&heard, signal);
  }
  // Linux ends a process for a fault of its own although the signal is held back.
  pthread_sigmask(SIG_BLOCK, &heard, nullptr);
  std::thread([heard, told = std::move(on_signal)] {
    while (true) {
      siginfo_t about{};
      const int signal = sigwaitinfo(&heard, &about);
      if (signal <= 0) continue;
      const bool sent = about.si_code == SI_USER || about.si_code == SI_QUEUE;
      told(signal, sent ? about.si_pid : 0);
    }
  }).detach();  // ends with the process
}

}  // namespace strainwave::bench
