// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/analysis/diagnosed.h"
#include "tests/analysis/generated_loop.h"

namespace strainwave::analysis::diagnosis {

/// What the program says of a generated loop.
inline Diagnosed DiagnoseLoop(const GeneratedGear& gear, const GeneratedSensors& sensors,
                              const std::vector<PathLeg>& path, std::size_t samples, std::uint32_t seed) {
  return DiagnoseRecords(&MakeHysteresisStudy,
                         std::vector<HysteresisData>{GenerateLoop(gear, sensors, path, samples, seed)});
}

}  // namespace strainwave::analysis::diagnosis
