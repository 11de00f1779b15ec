// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "bench/controller/phase_runner.h"
#include "bench/roles/bench_machine.h"

namespace strainwave::bench {

/// What a person has asked for, by a key, from another shell or through a service manager. None before one of
/// the two below.
const std::atomic<StopRequest>& Requested();

/// Whether the watchdog of the service manager was among them, by SIGABRT: no person has asked for that stop.
bool WatchdogHasStopped();

/// Whether the machine that goes down was what has asked for the stop, and no person had asked for one by a
/// signal. Waits for what the service manager says.
bool MachineHasStopped();

/// What stops sooner and harder wins over what was asked for before; never the other way round.
void Request(StopRequest request);

/// Of a campaign: SIGTERM is the safe shutdown, SIGUSR1 the pause, SIGUSR2 the end of the cycle, every other
/// signal the quick stop (`ListenToSignals` says which there are).
void ListenForRequests();

/// Where there is nothing to end softly: every signal is the quick stop.
void ListenForQuickStop();

/// Who has typed the command, also by sudo; "a person without a name" where nothing says it.
std::string PersonsName();

/// A person at the terminal says when it is done. A stop that is asked for meanwhile counts as a no.
bool Ask(const std::string& what);

/// The same, for what may also be left undone.
/// @return nothing where it was done; else why not, in the person's words.
std::optional<std::string> AskOrWhyNot(const std::string& what);

/// Waits for what must be done by hand before anything moves, and says what that is. A stop that is asked for
/// meanwhile ends the waiting.
void WaitForPeople(const BenchMachine& machine);

/// Waits for a value of every channel and drive, before anything moves.
/// @throws BenchError with what does not come, or where a stop is asked for meanwhile.
void WaitForValues(BenchMachine& machine);

}  // namespace strainwave::bench
