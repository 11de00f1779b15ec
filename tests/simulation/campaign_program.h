// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/wait.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "bench/campaign/journal.h"
#include "tests/checkout.h"

namespace strainwave {

inline const std::string kSchedule = SourceFolder() + "/tests/simulation/small.yaml";

/// Waits until the journal shows a phase of cycle 1 whose name is `phase`, or any where that is empty.
inline void WaitForPhase(const std::filesystem::path& folder, const std::string& phase, pid_t process) {
  while (true) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // polling another process: nothing to wait on
    siginfo_t ended{};
    ::waitid(P_PID, static_cast<id_t>(process), &ended, WEXITED | WNOHANG | WNOWAIT);
    if (ended.si_pid == process) return;
    try {
      const auto journal = bench::Journal::Open(folder / "campaign.db", bench::Database::Mode::kReadOnly);
      for (const bench::PhaseRow& row : journal.Phases(1)) {
        if (phase.empty() || row.name == phase) return;
      }
    } catch (const bench::DatabaseError&) {
      continue;  // not there yet
    }
  }
}

}  // namespace strainwave
