// SPDX-License-Identifier: Apache-2.0
// The control loop on a thread of its own, as on a bench of metal.
#include <atomic>
#include <stdexcept>

#include <gtest/gtest.h>

#include "bench/controller/make_program.h"
#include "tests/simulation/bench_fixture.h"

namespace strainwave::bench::loop_thread_test {
namespace {

// The simulated bench's clock, which holds the loop in its second second until a heartbeat has come: the
// simulation would else be over before the other thread has woken up.
class GatedClock final : public BenchClock {
 public:
  explicit GatedClock(BenchClock& clock) : clock_(clock) {}

  std::chrono::nanoseconds Now() const noexcept override { return clock_.Now(); }
  void SleepUntil(std::chrono::nanoseconds time) noexcept override {
    if (time > std::chrono::milliseconds(1500)) open_.wait(false);
    clock_.SleepUntil(time);
  }
  std::uint64_t Overruns() const noexcept override { return clock_.Overruns(); }

  void Open() {
    open_ = true;
    open_.notify_all();
  }

 private:
  BenchClock& clock_;
  std::atomic<bool> open_{};
};

RunnerSettings WithOwnThread() {
  RunnerSettings settings = TestSettings();
  settings.own_thread = true;
  return settings;
}

TEST(LoopThread, MeasuresWhatTheCallersThreadMeasures) {
  std::vector<PhaseOutcome> outcomes;
  for (const bool own : {false, true}) {
    RunnerSettings settings = TestSettings();
    settings.own_thread = own;
    SpiedBench bench(settings);
    const auto program = MakeProgram(TestHysteresis(), TestSpecimen(), 0.0, 0.01);
    outcomes.push_back(bench.runner.Run(*program, NoHeartbeat));
    EXPECT_FALSE(outcomes.back().reason) << Describe(outcomes.back().reason);
    EXPECT_TRUE(bench.Safe());
  }
  ASSERT_EQ(outcomes[0].records.size(), outcomes[1].records.size());
  for (std::size_t i = 0; i < outcomes[0].records.size(); ++i) {
    EXPECT_EQ(outcomes[0].records[i].record.CopyAsDoubles("torque_Nm"),
              outcomes[1].records[i].record.CopyAsDoubles("torque_Nm"));
  }
}

TEST(LoopThread, IsNotHeldUpByAHeartbeatThatTakesItsTime) {
  SpiedBench bench;
  GatedClock clock(bench.devices.clock);
  PhaseRunner runner({bench.driving, bench.load, bench.devices.sampler, clock}, WithOwnThread(),
                     bench.request);
  const auto program = MakeProgram(TestLoadRun(60.0), TestSpecimen(), 0.0, 0.01);
  const int stops_before = bench.driving.quick_stops;
  int beats = 0;
  // The first heartbeat lasts until the whole phase has run behind its back.
  const PhaseOutcome outcome = runner.Run(*program, [&](const PhaseSnapshot&, const PhaseProgram&) {
    ++beats;
    clock.Open();
    bench.driving.quick_stops.wait(stops_before);
  });
  EXPECT_FALSE(outcome.reason) << Describe(outcome.reason);
  // A second one can come between the stop and the end of the thread.
  EXPECT_LE(beats, 2);
  EXPECT_NEAR(outcome.credited_load_s, 60.0, 0.011);
}

// Passes readings on, with another torque in one of them.
class SpikedSampler final : public Sampler {
 public:
  SpikedSampler(Sampler& sampler, int at) : sampler_(sampler), at_(at) {}

  Readings Read() noexcept override {
    Readings readings = sampler_.Read();
    if (++reads_ == at_) readings.output_torque_Nm = kSpike_Nm;
    return readings;
  }
  void StartVibration(double rate_hz) override { sampler_.StartVibration(rate_hz); }
  void StopVibration() override { sampler_.StopVibration(); }
  void DrainVibration(VibrationBlock& block) override { sampler_.DrainVibration(block); }

  static constexpr double kSpike_Nm = 47.625;  // the limit is above

 private:
  Sampler& sampler_;
  const int at_;
  int reads_{};
};

// What a page shows of it: one reading of 30 000, while nobody takes what the loop hands over.
TEST(LoopThread, LosesNoExtremeToAHeartbeatThatTakesItsTime) {
  for (const int at : {150, 10'000, 30'000}) {
    SpiedBench bench;
    GatedClock clock(bench.devices.clock);
    SpikedSampler sampler(bench.devices.sampler, at);
    PhaseRunner runner({bench.driving, bench.load, sampler, clock}, WithOwnThread(), bench.request);
    const auto program = MakeProgram(TestLoadRun(310.0), TestSpecimen(), 0.0, 0.01);
    const int stops_before = bench.driving.quick_stops;
    const PhaseOutcome outcome = runner.Run(*program, [&](const PhaseSnapshot&, const PhaseProgram&) {
      clock.Open();
      bench.driving.quick_stops.wait(stops_before);
    });
    EXPECT_FALSE(outcome.reason) << Describe(outcome.reason);
    EXPECT_EQ(runner.TakeExtremes().channels[0].max, SpikedSampler::kSpike_Nm) << at;
    EXPECT_TRUE(runner.TakeExtremes().empty());
  }
}

TEST(LoopThread, HandsOverRowsWhileTheyAreWritten) {
  SpiedBench bench;
  GatedClock clock(bench.devices.clock);
  PhaseRunner runner({bench.driving, bench.load, bench.devices.sampler, clock}, WithOwnThread(),
                     bench.request);
  schedules::LoadRun run = TestLoadRun(600.0);
  run.log_rate_hz = 100.0;
  const auto program = MakeProgram(run, TestSpecimen(), 0.0, 0.01);
  std::size_t last_rows = 0;
  int beats = 0;
  const PhaseOutcome outcome =
      runner.Run(*program, [&](const PhaseSnapshot& now, const PhaseProgram& running) {
        ++beats;
        clock.Open();
        const std::vector<NamedRecord> so_far = running.RecordsSoFar();
        if (so_far.empty()) return;
        const auto time_s = so_far.front().record.Doubles("time_s");
        for (std::size_t i = 1; i < time_s.size(); ++i) ASSERT_GT(time_s[i], time_s[i - 1]);
        EXPECT_GE(time_s.size(), last_rows);
        EXPECT_LE(now.credited_load_s, running.credited_load_s());
        last_rows = time_s.size();
      });
  EXPECT_FALSE(outcome.reason) << Describe(outcome.reason);
  EXPECT_GT(beats, 0);
  EXPECT_GE(outcome.records.front().record.rows(), last_rows);
}

TEST(LoopThread, StopsBeforeTheExceptionOfAHeartbeatLeaves) {
  SpiedBench bench(WithOwnThread());
  const auto program = MakeProgram(TestLoadRun(36000.0), TestSpecimen(), 0.0, 0.01);
  EXPECT_THROW(bench.runner.Run(*program, [](const PhaseSnapshot&,
                                             const PhaseProgram&) { throw std::runtime_error("disk full"); }),
               std::runtime_error);
  EXPECT_TRUE(bench.Safe());
  EXPECT_EQ(bench.driving.set_points_after_stop, 0);
  EXPECT_LT(bench.devices.clock.Now(), std::chrono::hours(9)) << "the phase went on to its end";
}

TEST(LoopThread, NamesTheCauseOfAStop) {
  SpiedBench bench(WithOwnThread());
  const auto program = MakeProgram(TestLoadRun(36000.0), TestSpecimen(), 0.0, 0.01);
  const PhaseOutcome outcome = bench.runner.Run(
      *program, [&](const PhaseSnapshot&, const PhaseProgram&) { bench.request = StopRequest::kQuickStop; });
  EXPECT_EQ(outcome.reason.cause, StopCause::kQuickStopRequested);
  EXPECT_TRUE(bench.Safe());
}

}  // namespace
}  // namespace strainwave::bench::loop_thread_test
