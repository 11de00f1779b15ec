// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hwy/targets.h>

#include <cstdint>

/// Results on narrower machines than this one.
namespace strainwave::testing_machines {

/// Calls `task(name)` with Highway's loops as each kind of machine runs them whose instructions this one has.
template <typename Task>
void OnEachMachine(const Task& task) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    task(hwy::TargetName(target));
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace strainwave::testing_machines
