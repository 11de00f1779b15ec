// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace strainwave::bench {

/// Memory that is kept back for the end of a run. The first request for memory that the machine refuses, on
/// whichever thread, has it given up, so that no thread ends where it stands, with shafts under torque; what
/// is refused after that is a std::bad_alloc. One at a time.
class SpareMemory {
 public:
  /// @throws std::bad_alloc
  SpareMemory();
  SpareMemory(const SpareMemory&) = delete;
  SpareMemory& operator=(const SpareMemory&) = delete;
  ~SpareMemory();

  /// @throws std::bad_alloc once it had to be given up.
  static void DemandKept();

 private:
  static void GiveUp();
  void Free();

  std::array<void*, 128> blocks_{};  // 8 MiB
};

}  // namespace strainwave::bench
