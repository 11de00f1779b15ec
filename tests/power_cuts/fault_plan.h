// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace strainwave::power_cuts {

enum class Operation {
  kLookUp,
  kOpen,
  kRead,
  kList,
  kOpenToWrite,
  kCreate,
  kMakeFolder,
  kWrite,
  kResize,
  kSync,
  kRename,
  kRemove
};
const char* Name(Operation operation);

/// Which operations fail, and how long a write takes.
class FaultPlan {
 public:
  unsigned long fail_at{};  // operations from 1; 0: none
  int error{};              // errno; but EIO it is none of operations that change nothing
  bool lasting{};           // all that come after it fail, too
  std::string only{};       // the name of an operation; empty: any
  int write_ms{};           // once writes are slow

  /// Counts an operation; waits where it is a slow write.
  /// @return the errno with which it fails, 0 where it does not.
  int Meet(Operation operation, const std::string& name);
  /// What failed first, as "write campaign.db-wal"; empty: nothing did.
  const std::string& failed() const { return failed_; }
  unsigned long met() const { return met_; }

  /// From a signal handler: nothing fails any more; writes become slow, or quick again.
  static void End() noexcept;
  static void ChangePace() noexcept;

 private:
  unsigned long met_{};
  std::string failed_{};
};

}  // namespace strainwave::power_cuts
