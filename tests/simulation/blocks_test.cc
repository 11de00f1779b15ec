// SPDX-License-Identifier: Apache-2.0
// A load run whose angles and torque come in blocks, as from a stream, on the simulated bench.
#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include "bench/controller/make_program.h"
#include "tests/simulation/bench_fixture.h"

namespace strainwave::bench::blocks_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

// Gives the last sample of the newest block, and that only is new then.
class InBlocks final : public Sampler {
 public:
  InBlocks(Sampler& sampler, nanoseconds block) : sampler_(sampler), block_(block) {}

  Readings Read() noexcept override {
    const Readings now = sampler_.Read();
    if (now.time / block_ != told_.time / block_ || told_.time.count() == 0) told_ = now;
    return told_;
  }
  void StartVibration(double sample_rate_hz) override { sampler_.StartVibration(sample_rate_hz); }
  void StopVibration() override { sampler_.StopVibration(); }
  void DrainVibration(VibrationBlock& block) override { sampler_.DrainVibration(block); }

 private:
  Sampler& sampler_;
  nanoseconds block_;
  Readings told_;
};

TEST(BlocksOfSamples, EndsParkedAtBlocksOf10To500Milliseconds) {
  for (const milliseconds block :
       {milliseconds(10), milliseconds(100), milliseconds(200), milliseconds(500)}) {
    SpiedBench bench;
    InBlocks sampler(bench.machine.bench().sampler(), block);
    RunnerSettings settings = TestSettings();
    settings.stale_after_s = 1.0;
    PhaseRunner runner({bench.driving, bench.load, sampler, bench.machine.bench().clock()}, settings,
                       bench.request);
    const schedules::Specimen specimen = TestSpecimen();
    const auto program = MakeProgram(TestLoadRun(10.0), specimen, 0.0, settings.control_period_s);
    const PhaseOutcome outcome = runner.Run(*program, NoHeartbeat);
    EXPECT_FALSE(outcome.reason) << block.count() << " ms: " << Describe(outcome.reason);
    const Readings end = bench.machine.bench().sampler().Read();
    EXPECT_NEAR(end.input_angle_rad, HomeInput_rad(end, specimen.ratio), 0.02) << block.count() << " ms";
  }
}

}  // namespace
}  // namespace strainwave::bench::blocks_test
