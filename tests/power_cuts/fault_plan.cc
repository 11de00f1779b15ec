// SPDX-License-Identifier: Apache-2.0
#include "tests/power_cuts/fault_plan.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <thread>

namespace strainwave::power_cuts {
namespace {

volatile std::sig_atomic_t ended = 0;
volatile std::sig_atomic_t slow = 0;

bool Changes(Operation operation) {
  return operation != Operation::kLookUp && operation != Operation::kOpen && operation != Operation::kRead &&
         operation != Operation::kList;
}

}  // namespace

const char* Name(Operation operation) {
  switch (operation) {
    case Operation::kLookUp:
      return "look_up";
    case Operation::kOpen:
      return "open";
    case Operation::kRead:
      return "read";
    case Operation::kList:
      return "list";
    case Operation::kOpenToWrite:
      return "open_to_write";
    case Operation::kCreate:
      return "create";
    case Operation::kMakeFolder:
      return "make_folder";
    case Operation::kWrite:
      return "write";
    case Operation::kResize:
      return "resize";
    case Operation::kSync:
      return "sync";
    case Operation::kRename:
      return "rename";
    case Operation::kRemove:
      return "remove";
  }
  return "";
}

int FaultPlan::Meet(Operation operation, const std::string& name) {
  if (slow != 0 && operation == Operation::kWrite) {
    std::this_thread::sleep_for(std::chrono::milliseconds(write_ms));
  }
  if (!only.empty() && only != Name(operation)) return 0;
  if (error != EIO && !Changes(operation)) return 0;
  ++met_;
  if (fail_at == 0 || met_ < fail_at || (met_ > fail_at && !lasting) || ended != 0) return 0;
  if (failed_.empty()) failed_ = std::string(Name(operation)) + " " + name;
  return error;
}

void FaultPlan::End() noexcept { ended = 1; }
void FaultPlan::ChangePace() noexcept { slow = 1 - slow; }

}  // namespace strainwave::power_cuts
