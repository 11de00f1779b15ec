// SPDX-License-Identifier: Apache-2.0
// A torque transducer whose zero creeps while the gear is under load. No reading gives it away; the next zero
// check does, before anything is measured with it.
#include <filesystem>
#include <fstream>
#include <limits>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "bench/campaign/campaign.h"
#include "bench/campaign/campaign_runner.h"
#include "bench/configuration/embedded_bench.h"
#include "bench/machines/plant_model_of.h"
#include "bench/machines/simulated_machine.h"
#include "daq/whole_file.h"
#include "tests/checkout.h"
#include "tests/schedules/schedule_text.h"
#include "tests/simulation/program.h"

namespace strainwave::bench::transducer_drift_test {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
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
  void CycleStored(int, const std::vector<Result>& results) override { results_ = results; }

  double Value(const std::string& quantity) const {
    for (const Result& result : results_) {
      if (result.quantity == quantity) return result.value;
    }
    return kUnknown;
  }

 private:
  SimulatedBench& bench_;
  double drift_Nm_per_s_;
  bool creeps_{};
  std::vector<Result> results_;
};

class TransducerDrift : public testing::Test {
 protected:
  TransducerDrift() {
    std::string text =
        daq::ReadWholeFile(std::filesystem::path(SourceFolder()) / "tests/simulation/small.yaml");
    text = schedules::With(text, "cycles: 3", "cycles: 1");
    text = schedules::With(text, "duration: 20 min ", "duration: 10 min ");
    text = schedules::With(text, "operator_acknowledges: true", "operator_acknowledges: false");
    text = schedules::With(text, "  - kind: load_run\n",
                           "  - {kind: zero_check, allowed: 0.25 Nm}\n\n  - kind: load_run\n");
    text = schedules::With(text, "measurements:\n",
                           "  - {kind: zero_check, name: last_zero, allowed: 0.25 Nm}\n\nmeasurements:\n");
    text = schedules::With(text, "  - kind: measurement_rotation\n",
                           "  - {kind: zero_check, name: loaded_zero, allowed: 0.25 Nm}\n\n"
                           "  - kind: measurement_rotation\n");
    std::ofstream(scratch_ / "schedule.yaml") << text;
    WriteBench("");
  }

  // Warmth moves the zero, too, but not here.
  void WriteBench(const std::string& further_term) {
    std::ofstream(scratch_ / "bench.yaml")
        << schedules::With(EmbeddedBenchText(), "plant: []",
                           "plant: [{term: torque_zero_drift, enabled: false}" + further_term + "]");
  }

  CampaignEnd Run(double drift_Nm_per_s, bool resumed) {
    const CampaignInputs inputs = ReadInputs(scratch_ / "schedule.yaml", scratch_ / "bench.yaml");
    Journal journal = resumed ? Journal::Open(folder_.Journal(), Database::Mode::kReadWrite)
                              : CreateCampaign(folder_, inputs);
    const ResumePoint from = resumed ? PrepareResume(folder_, inputs, journal, {.by = "a person"}).value() : ResumePoint{};
    SimulatedMachine machine(PlantModelOf(inputs.bench, 80.0), {}, {});
    Creeping creeping(machine.bench(), drift_Nm_per_s);
    const std::atomic<StopRequest> request{StopRequest::kNone};
    CampaignRunner runner(HeldFolder(folder_), inputs.schedule, inputs.bench, machine, journal, request,
                          creeping);
    const CampaignEnd end = runner.Run(from);
    phases_ = journal.Phases(1);
    for (const char* const check : {"zero_check_Nm", "loaded_zero_Nm", "last_zero_Nm"}) {
      zeros_Nm_.push_back(creeping.Value(check));
    }
    return end;
  }

  ScratchFolder scratch_;
  CampaignFolder folder_{scratch_ / "campaign"};
  std::vector<PhaseRow> phases_;
  std::vector<double> zeros_Nm_;  // before and after the load run, and after the hysteresis test
};

TEST_F(TransducerDrift, DuringALoadRunIsFoundByTheNextZeroCheck) {
  const CampaignEnd end = Run(kDrift_Nm_per_s, false);
  EXPECT_EQ(end.kind, CampaignEnd::Kind::kFault) << end.text;
  const std::regex words(
      "a sensor does not show what it should: zero check: 0\\.(4|5)[0-9]* is further than 0\\.25 from 0 "
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

// The load drive's friction holds 0.5 Nm of whatever it was last turned by.
TEST_F(TransducerDrift, OfNoneIsSeenWhateverTurnedBefore) {
  ASSERT_EQ(Run(0.0, false).kind, CampaignEnd::Kind::kCompleted);
  for (const double zero_Nm : zeros_Nm_) EXPECT_NEAR(zero_Nm, 0.0, 0.06);
}

TEST_F(TransducerDrift, AZeroThatIsOffIsSeenWhateverTurnedBefore) {
  WriteBench(", {term: torque_zero_offset, parameters: {offset_Nm: 0.2}}");
  ASSERT_EQ(Run(0.0, false).kind, CampaignEnd::Kind::kCompleted);
  for (const double zero_Nm : zeros_Nm_) EXPECT_NEAR(zero_Nm, 0.2, 0.06);
}

}  // namespace
}  // namespace strainwave::bench::transducer_drift_test
