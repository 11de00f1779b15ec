// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/person.h"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <system_error>
#include <thread>

#include <fmt/core.h>

#include "bench/commands/output.h"
#include "bench/commands/service_manager.h"
#include "bench/commands/signals.h"
#include "bench/devices/wake.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

std::atomic<StopRequest> g_request{StopRequest::kNone};
std::atomic<bool> g_watchdog{};
std::atomic<bool> g_person{};

// What the service manager says of the machine, asked for when its SIGTERM comes: later it may be on its way
// down for another reason.
enum class Machine : int { kNotAsked, kAsked, kStaysUp, kGoesDown };
std::atomic<Machine> g_machine{Machine::kNotAsked};

constexpr pid_t kMachinesManager = 1;  // its first process

// On a thread of its own, for the next signal may be a quick stop.
void AskAboutMachine() {
  const auto answered = [](Machine answer) {
    g_machine = answer;
    g_machine.notify_all();
  };
  try {
    std::thread([=] { answered(MachineGoesDown() ? Machine::kGoesDown : Machine::kStaysUp); }).detach();
  } catch (const std::system_error&) {
    answered(Machine::kStaysUp);
  }
}

StopRequest RequestOf(int signal) {
  switch (signal) {
    case SIGTERM:
      return StopRequest::kShutdown;
    case SIGUSR1:
      return StopRequest::kPause;
    case SIGUSR2:
      return StopRequest::kFinishCycle;
    default:
      return StopRequest::kQuickStop;
  }
}

constexpr std::size_t kLongestAnswer = 200;

// A line of standard input; nothing where nobody is there, or a stop is asked for meanwhile.
std::optional<std::string> ReadAnswer() {
  std::string answer;
  while (g_request == StopRequest::kNone) {
    if (WaitReadable(STDIN_FILENO, nullptr, std::chrono::milliseconds(100)) != Waited::kReadable) continue;
    char key = 0;
    const ssize_t got = ::read(STDIN_FILENO, &key, 1);
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got <= 0) return std::nullopt;
    if (key == '\n') return answer;
    if (answer.size() < kLongestAnswer) answer += key;
  }
  return std::nullopt;
}

}  // namespace

const std::atomic<StopRequest>& Requested() { return g_request; }

bool WatchdogHasStopped() { return g_watchdog; }

bool MachineHasStopped() {
  g_machine.wait(Machine::kAsked);
  return g_machine == Machine::kGoesDown && !g_person;
}

void Request(StopRequest request) {
  StopRequest before = g_request;
  while (before < request && !g_request.compare_exchange_weak(before, request)) {
  }
}

void ListenForRequests() {
  ListenToSignals([](int signal, pid_t sender) {
    const bool managers = signal == SIGTERM && sender == kMachinesManager;
    if (signal == SIGABRT) {
      g_watchdog = true;
    } else if (!managers) {
      g_person = true;
    }
    Machine before = Machine::kNotAsked;
    const bool first = managers && g_machine.compare_exchange_strong(before, Machine::kAsked);
    Request(RequestOf(signal));
    if (first) AskAboutMachine();
  });
}

void ListenForQuickStop() {
  ListenToSignals([](int, pid_t) { Request(StopRequest::kQuickStop); });
}

std::string PersonsName() {
  for (const char* const variable : {"SUDO_USER", "USER"}) {
    if (const char* const name = std::getenv(variable); name != nullptr && *name != '\0') return name;
  }
  return "a person without a name";
}

bool Ask(const std::string& what) {
  ToStderr("\n{}, then press Enter\n", what);
  return ReadAnswer().has_value();
}

std::optional<std::string> AskOrWhyNot(const std::string& what) {
  ToStderr("\n{}, then press Enter; or write why not, and press Enter\n", what);
  const std::optional<std::string> answer = ReadAnswer();
  if (!answer) return "nobody has answered";
  return answer->empty() ? std::nullopt : answer;
}

void WaitForPeople(const BenchMachine& machine) {
  std::string told;
  while (g_request == StopRequest::kNone) {
    const std::string missing = machine.MissingForStart();
    if (missing.empty()) return;
    if (missing != told) ToStderr("waiting: {}\n", missing);
    told = missing;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

void WaitForValues(BenchMachine& machine) {
  const std::string missing = machine.AwaitValues([] { return g_request != StopRequest::kNone; });
  if (g_request != StopRequest::kNone) {
    throw BenchError(ExitCode::kInterrupted, "stopped on request; nothing was moved");
  }
  if (!missing.empty()) throw BenchError(ExitCode::kMachineFailed, fmt::format("error: {}", missing));
}

}  // namespace strainwave::bench
