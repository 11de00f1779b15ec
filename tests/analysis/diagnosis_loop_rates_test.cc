// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/generated_loop.h"

namespace strainwave::analysis::diagnosis {
namespace {

// A ramp of three times the torque's noise a sample, which has one rate: what is left of the noise is none.
TEST(RateDependence, IsNoneOfTheTorquesNoise) {
  const std::vector<PathLeg> path{{34.0, 7.2}, {-34.0, 7.2}, {0.0, 7.2}};
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const Diagnosed clean = DiagnoseRecords(
        &MakeHysteresisStudy,
        std::vector<HysteresisData>{GenerateLoop(
            {}, {.torque_noise_Nm = 0.02, .angle_noise_rad = RadFromArcmin(0.003)}, path, 2400, seed)});
    EXPECT_EQ(clean.names(), Names()) << seed;
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis
