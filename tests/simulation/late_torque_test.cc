// SPDX-License-Identifier: Apache-2.0
// A torque amplifier whose samples come late, with the time when they were taken: the loop is as wide as with
// one that is on time.
#include <array>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "bench/campaign/record_results.h"
#include "bench/controller/make_program.h"
#include "tests/simulation/bench_fixture.h"

namespace strainwave::bench::late_torque_test {
namespace {

// Tells the torque of some readings ago, and its time.
class LateTorque final : public Sampler {
 public:
  LateTorque(Sampler& sampler, std::size_t readings) : sampler_(sampler), late_(readings) {}

  Readings Read() noexcept override {
    Readings readings = sampler_.Read();
    past_[count_ % past_.size()] = readings;
    const Readings& then = past_[(count_ - std::min(late_, count_)) % past_.size()];
    ++count_;
    readings.output_torque_Nm = then.output_torque_Nm;
    readings.torque_time = then.torque_time;
    return readings;
  }
  void StartVibration(double rate_hz) override { sampler_.StartVibration(rate_hz); }
  void StopVibration() override { sampler_.StopVibration(); }
  void DrainVibration(VibrationBlock& block) override { sampler_.DrainVibration(block); }

 private:
  Sampler& sampler_;
  std::size_t late_;
  std::size_t count_{};
  std::array<Readings, 16> past_{};
};

// Width of the first loop, and K1.
std::pair<double, double> LoopWith(std::size_t readings_late) {
  SimulatedMachine machine(analysis::model::DefaultPlantModel(), {}, {});
  LateTorque sampler(machine.bench().sampler(), readings_late);
  std::atomic<StopRequest> request{StopRequest::kNone};
  PhaseRunner runner(
      {machine.bench().driving_servo(), machine.bench().load_servo(), sampler, machine.bench().clock()},
      TestSettings(), request);
  schedules::HysteresisTest test = TestHysteresis();
  test.torque_rate_Nm_per_s = 20.0;
  test.log_rate_hz = 100.0;
  test.lock_angles_rad = {0.0};
  const auto program = MakeProgram(test, TestSpecimen(), 0.0, 0.01);
  const PhaseOutcome outcome = runner.Run(*program, NoHeartbeat);
  EXPECT_FALSE(outcome.reason) << Describe(outcome.reason);
  const auto stiffness = StiffnessOf(outcome.records.front().record, analysis::StiffnessMethod::kModel, {});
  return {ArcminFromRad(stiffness.hysteresis_rad.value), stiffness.k1_Nm_per_rad.value};
}

// 30 ms at 20 Nm/s are 0.6 Nm each way: 0.26' of width where they are not known.
TEST(LateTorque, DoesNotWidenTheLoop) {
  const auto [width_arcmin, k1_Nm_per_rad] = LoopWith(0);
  const auto [late_width_arcmin, late_k1_Nm_per_rad] = LoopWith(3);
  EXPECT_NEAR(late_width_arcmin, width_arcmin, 0.01);
  EXPECT_NEAR(late_k1_Nm_per_rad, k1_Nm_per_rad, 0.005 * k1_Nm_per_rad);
}

}  // namespace
}  // namespace strainwave::bench::late_torque_test
