// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/analysis/on_threads.h"
#include "tests/analysis/vibration_record.h"

namespace strainwave::analysis::diagnosis::diagnosis_threads_test {
namespace {

// A train of impulses, a tone and coloured noise: a cause and a nuisance term, found one beside the other.
Signal Hidden(const Turning& run) {
  Signal signal = ColouredNoise(run, 7, 0.1, 0.5);
  for (double start_s = 0.004; start_s < run.time_s.back(); start_s += kTwoPi / 9.45 / run.speed_rad_per_s[0])
    AddRinging(run, start_s, 0.3, 1230.0, 0.03, signal);
  for (std::size_t i = 0; i < signal.size(); ++i) signal[i] += 0.2 * std::cos(kTwoPi * 333.3 * run.time_s[i]);
  return signal;
}

Diagnosis DiagnoseOn(const ParallelFor& parallel, const VibrationData& record) {
  DiagnoseOptions options;
  options.parallel = parallel;
  std::atomic<int> telling{0};
  options.progress = [&](const std::string&, double) {
    EXPECT_EQ(++telling, 1);
    --telling;
  };
  return Diagnose(*MakeVibrationStudy({&record, 1}, parallel), options);
}

TEST(DiagnoseOnThreads, GivesTheSameBitsOnAnyNumberOfThreads) {
  const VibrationData record = Record(Turning(1500.0, 1.2, 0.0), 5, Hidden, {1.0, -0.6, 0.4});
  const Diagnosis alone = DiagnoseOn(InTurn, record);
  const Diagnosis together = DiagnoseOn(OnThreads, record);
  ASSERT_FALSE(alone.causes.empty());
  ASSERT_FALSE(alone.nuisance_terms.empty());
  EXPECT_EQ(together.extended.predicted, alone.extended.predicted);
  EXPECT_EQ(together.extended.state, alone.extended.state);
  EXPECT_EQ(together.extended_heldout_rmse, alone.extended_heldout_rmse);
  EXPECT_EQ(together.residual.signature, alone.residual.signature);
  ASSERT_EQ(together.candidates.size(), alone.candidates.size());
  for (std::size_t i = 0; i < alone.candidates.size(); ++i) {
    EXPECT_EQ(together.candidates[i].index, alone.candidates[i].index);
    EXPECT_EQ(together.candidates[i].evidence.delta_bic, alone.candidates[i].evidence.delta_bic);
    EXPECT_EQ(together.candidates[i].objection, alone.candidates[i].objection);
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_threads_test
