// SPDX-License-Identifier: Apache-2.0
// A torque transducer whose zero creeps while the gear is under load. No reading gives it away; the next zero
// check does, before anything is measured with it.
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "bench/campaign/campaign.h"
#include "bench/campaign/campaign_runner.h"
#include "bench/configuration/embedded_bench.h"
#include "bench/devices/plant_model_of.h"
#include "bench/devices/simulated_machine.h"
#include "daq/whole_file.h"
#include "tests/schedules/schedule_text.h"
#include "tests/simulation/program.h"

namespace strainwave::bench {
namespace {

// Beside the 0.5 Nm that the check finds on this bench anyway.
constexpr double kDrift_Nm_per_s = 0.5 / 600.0;

// Creeps from the first sign of the load run on.
class Creeping final : public ProgressSink {
 public:
  Creeping(SimulatedBench& bench, double drift_Nm_per_s) : bench_(bench), drift_Nm_per_s_(drift_Nm_per_s) {}

  void Update(const ProgressState& state) override {
    if (state.phase != "load_run" || creeps_ || drift_Nm_per_s_ == 0.0) return;
    bench_.Inject({.drifting_channels = 1U << static_cast<unsigned>(Channel::kOutputTorque),
                   .drift_per_s = drift_Nm_per_s_});
    creeps_ = true;
  }
  void Message(std::string_view, std::string_view) override {}
  void CycleStored(int, const std::vector<Result>&) override {}

 private:
  SimulatedBench& bench_;
  double drift_Nm_per_s_;
  bool creeps_{};
};

class TransducerDrift : public testing::Test {
 protected:
  TransducerDrift() {
    std::string text =
        daq::ReadWholeFile(std::filesystem::path(STRAINWAVE_SOURCE_DIR) / "tests/simulation/small.yaml");
    text = schedules::With(text, "cycles: 3", "cycles: 1");
    text = schedules::With(text, "duration: 20 min ", "duration: 10 min ");
    text = schedules::With(text, "operator_acknowledges: true", "operator_acknowledges: false");
    text = schedules::With(text, "  - kind: load_run\n",
                           "  - {kind: zero_check, allowed: 0.75 Nm}\n\n  - kind: load_run\n");
    text = schedules::With(text, "  - kind: measurement_rotation\n",
                           "  - {kind: zero_check, name: loaded_zero, allowed: 0.75 Nm}\n\n"
                           "  - kind: measurement_rotation\n");
    std::ofstream(scratch_ / "schedule.yaml") << text;
    // Warmth moves the zero, too, but not here.
    std::ofstream(scratch_ / "bench.yaml") << schedules::With(
        EmbeddedBenchText(), "plant: []", "plant: [{term: torque_zero_drift, enabled: false}]");
  }

  CampaignEnd Run(double drift_Nm_per_s, bool resumed) {
    const CampaignInputs inputs = ReadInputs(scratch_ / "schedule.yaml", scratch_ / "bench.yaml");
    Journal journal = resumed ? Journal::Open(folder_.Journal(), Database::Mode::kReadWrite)
                              : CreateCampaign(folder_, inputs);
    const ResumePoint from = resumed ? PrepareResume(folder_, inputs, journal, false).value() : ResumePoint{};
    SimulatedMachine machine(PlantModelOf(inputs.bench, 80.0), {}, {});
    Creeping creeping(machine.bench(), drift_Nm_per_s);
    const std::atomic<StopRequest> request{StopRequest::kNone};
    CampaignRunner runner(folder_, inputs.schedule, inputs.bench, machine, journal, request, creeping);
    const CampaignEnd end = runner.Run(from.checkpoint, from.pause_s);
    phases_ = journal.Phases(1);
    return end;
  }

  ScratchFolder scratch_;
  CampaignFolder folder_{scratch_ / "campaign"};
  std::vector<PhaseRow> phases_;
};

TEST_F(TransducerDrift, DuringALoadRunIsFoundByTheNextZeroCheck) {
  const CampaignEnd end = Run(kDrift_Nm_per_s, false);
  EXPECT_EQ(end.kind, CampaignEnd::Kind::kFault) << end.text;
  const std::regex words(
      "a sensor does not show what it should: zero check: (0\\.99|1\\.0)[0-9]* is further than 0\\.75 from 0 "
      "\\(in "
      "Nm\\); look for a torque that is locked in between the brakes and for a loose plug, then zero the "
      "amplifier or have the transducer calibrated");
  EXPECT_TRUE(std::regex_match(end.text, words)) << end.text;
  // The load run is done and paid for; nothing was measured with the wrong zero.
  ASSERT_GE(phases_.size(), 2u);
  EXPECT_EQ(phases_[phases_.size() - 2].kind, "load_run");
  EXPECT_EQ(phases_[phases_.size() - 2].outcome, "complete");
  EXPECT_EQ(phases_.back().kind, "zero_check");
  EXPECT_EQ(phases_.back().outcome, "fault");

  // With the amplifier zeroed it goes on from the check.
  const std::size_t before = phases_.size();
  const CampaignEnd resumed = Run(0.0, true);
  EXPECT_EQ(resumed.kind, CampaignEnd::Kind::kCompleted) << resumed.text;
  EXPECT_EQ(phases_[before].kind, "zero_check");
}

TEST_F(TransducerDrift, OfHalfOfWhatTheCheckLeavesStopsNothing) {
  EXPECT_EQ(Run(0.25 * kDrift_Nm_per_s, false).kind, CampaignEnd::Kind::kCompleted);
}

}  // namespace
}  // namespace strainwave::bench
