// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/analysis/diagnosed.h"
#include "tests/analysis/generated_loop.h"

namespace strainwave::analysis::diagnosis::diagnosis_coarse_loop_test {
namespace {

// Each of the record's `every` samples from `first` on.
HysteresisData EveryFew(const HysteresisData& fine, std::size_t first, std::size_t every) {
  HysteresisData coarse = fine;
  for (std::vector<double>* column : {&coarse.time_s, &coarse.torque_Nm, &coarse.output_angle_rad}) {
    const std::vector<double> all = std::move(*column);
    column->clear();
    for (std::size_t i = first; i < all.size(); i += every) column->push_back(all[i]);
  }
  return coarse;
}

// Samples are further apart than the friction yields, and each peak lies between two of them: what the
// friction keeps of it is on the same side at each turn, and nobody hid it.
TEST(CoarseLoop, HidesNothingWhereThePeaksLieBetweenSamples) {
  const std::vector<PathLeg> path = Loops(5, {{33.0, 1.0}, {34.0, 0.6}, {33.2, 0.6}});
  for (const std::size_t every : {40U, 47U, 53U, 59U}) {
    const HysteresisData fine =
        GenerateLoop({.friction_Nm = {0.7}, .yield_rad = {1.2e-4}},
                     {.torque_noise_Nm = 0.0003, .angle_noise_rad = RadFromArcmin(0.004)}, path, 20000, 7);
    const Diagnosed found =
        DiagnoseRecords(&MakeHysteresisStudy, std::vector<HysteresisData>{EveryFew(fine, every / 2, every)});
    EXPECT_EQ(found.names(), Names()) << every;
    EXPECT_EQ(found.diagnosis.verdict, Verdict::kNoEffect) << every << found.diagnosis.residual.signature;
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_coarse_loop_test
