// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/person.h"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <iostream>
#include <thread>

#include <fmt/core.h>

#include "bench/devices/wake.h"

namespace strainwave::bench {
namespace {

std::atomic<StopRequest> g_request{StopRequest::kNone};

// A second Ctrl-C does not abandon the stop that the first one has begun.
void OnSignal(int signal) {
  switch (signal) {
    case SIGINT:
      g_request = StopRequest::kQuickStop;
      return;
    case SIGTERM:
      g_request = StopRequest::kShutdown;
      return;
    case SIGUSR1:
      g_request = StopRequest::kPause;
      return;
    case SIGUSR2:
      g_request = StopRequest::kFinishCycle;
      return;
    default:
      return;
  }
}

}  // namespace

std::atomic<StopRequest>& Requested() { return g_request; }

void ListenToSignals() {
  struct sigaction action {};
  action.sa_handler = OnSignal;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1, SIGUSR2}) sigaction(signal, &action, nullptr);
}

bool Ask(const std::string& what) {
  fmt::print(stderr, "\n{}, then press Enter\n", what);
  while (g_request == StopRequest::kNone) {
    if (WaitReadable(STDIN_FILENO, nullptr, std::chrono::milliseconds(100)) != Waited::kReadable) continue;
    std::string line;
    return static_cast<bool>(std::getline(std::cin, line));
  }
  return false;
}

void WaitForPeople(const BenchMachine& machine) {
  std::string told;
  while (g_request == StopRequest::kNone) {
    const std::string missing = machine.MissingForStart();
    if (missing.empty()) return;
    if (missing != told) fmt::print(stderr, "waiting: {}\n", missing);
    told = missing;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

}  // namespace strainwave::bench
