// SPDX-License-Identifier: Apache-2.0
// A campaign on devices that fail in the middle of a phase, in real time: what it says, and that it comes to
// its end after the fault, by itself or resumed. Every fault in every phase: STRAINWAVE_FAULT_MATRIX=1 (an
// hour).
#include <filesystem>
#include <fstream>
#include <iostream>
#include <thread>

#include <gtest/gtest.h>

#include "bench/campaign/campaign.h"
#include "bench/campaign/campaign_runner.h"
#include "bench/machines/field/field_machine.h"
#include "daq/whole_file.h"
#include "tests/checkout.h"
#include "tests/schedules/schedule_text.h"
#include "tests/simulation/device_faults.h"
#include "tests/simulation/program.h"

namespace strainwave::bench::field_resume_test {
namespace {

const std::filesystem::path kSource = SourceFolder();
constexpr int kBeat = 3;  // of the progress within the phase: by then every phase moves something

// From the phase of this kind up to `end`.
std::string Without(std::string text, const std::string& kind, const std::string& end) {
  const std::size_t from = text.find("  - kind: " + kind);
  return text.erase(from, text.find(end, from) - from);
}

// A driving servo on Modbus does not move to positions; without them a cycle is shorter.
std::string ShortSchedule(bool with_positions) {
  std::string text = daq::ReadWholeFile(kSource / "tests/vm/campaign/short.yaml");
  text = schedules::With(text, "dwell: 1 min", "dwell: 1 s");
  text = schedules::With(text, "step: 5 deg\n    steps: 72", "step: 10 deg\n    steps: 36");
  text = schedules::With(text, "vibration_rate: 25.6 kHz", "vibration_rate: 12.8 kHz");
  text = schedules::With(text, "input_speed: 300 rpm", "input_speed: 1000 rpm");
  text = schedules::With(text, "torque_rate: 8 Nm/s", "torque_rate: 20 Nm/s");
  // From one angle to the next the input turns.
  text = schedules::With(text, "lock_angles: [0 deg]", "lock_angles: [0 deg, 10 deg]");
  if (!with_positions) text = Without(text, "transmission_error", "measurements:");
  return schedules::With(text, "operator_acknowledges: true", "operator_acknowledges: false");
}

// A drive on CAN that falls silent during a measurement rotation, and one on Modbus that drops out under
// load.
bool IsOnlyAtLength(FaultInPhase pair) {
  const Fault& fault = Faults()[pair.fault];
  if (fault.bench == TestedBench::kCan) return pair.fault == 1 && pair.phase == 1;
  return pair.phase == 0 && fault.name.ends_with("drops out of operation enabled");
}

// Has the devices fail once in one phase, and mends them when the campaign waits for that.
class Saboteur final : public ProgressSink {
 public:
  Saboteur(const Fault& fault, const TestedPhase& phase) : fault_(fault), phase_(phase) {}
  void WorkOn(DeviceSide* devices) { devices_ = devices; }

  void Update(const ProgressState& state) override {
    if (state.phase != phase_.name || ++beats_ != kBeat) return;
    devices_->Do(CommandIn(fault_, phase_));
    did_ = true;
  }
  void Message(std::string_view, std::string_view text) override {
    said_ += std::string(text) + '\n';
    if (did_ && !mended_ && !fault_.mend.empty() && text.find(fault_.words) != std::string_view::npos) {
      devices_->Do(fault_.mend);
      mended_ = true;
    }
  }
  void CycleStored(int cycle, const std::vector<Result>&) override { stored_ += cycle == 1; }

  bool did() const { return did_; }
  int stored() const { return stored_; }
  const std::string& said() const { return said_; }

 private:
  const Fault& fault_;
  const TestedPhase& phase_;
  DeviceSide* devices_{};
  int beats_{};
  bool did_{};
  bool mended_{};
  int stored_{};
  std::string said_;
};

class FieldResume : public testing::Test {
 protected:
  CampaignEnd Run(const CampaignFolder& folder, Saboteur& saboteur, TestedBench bench, bool resumed) {
    const CampaignInputs inputs = ReadInputs(scratch_ / "schedule.yaml", BenchFileOf(bench));
    Journal journal = resumed ? Journal::Open(folder.Journal(), Database::Mode::kReadWrite)
                              : CreateCampaign(folder, inputs);
    const ResumePoint from = resumed ? PrepareResume(folder, inputs, journal, {.by = "a person"}).value() : ResumePoint{};
    FieldMachine machine(inputs.bench, 80.0, {});
    while (machine.Devices().sampler.Read().bad_channels != 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    saboteur.WorkOn(machine.device_side());
    const std::atomic<StopRequest> request{StopRequest::kNone};
    CampaignRunner runner(HeldFolder(folder), inputs.schedule, inputs.bench, machine, journal, request,
                          saboteur);
    const CampaignEnd end = runner.Run(from);
    EXPECT_TRUE(machine.device_side()->StandsSafe());
    return end;
  }

  void Check(const Fault& fault, const TestedPhase& phase, bool with_positions) {
    const std::string where = fault.name + " during " + phase.name;
    SCOPED_TRACE(where);
    std::ofstream(scratch_ / "schedule.yaml") << ShortSchedule(with_positions);
    const CampaignFolder folder{scratch_ / where};
    Saboteur saboteur(fault, phase);
    CampaignEnd end = Run(folder, saboteur, fault.bench, false);
    ASSERT_TRUE(saboteur.did()) << "the phase was over before the fault";
    const bool waits = !fault.mend.empty();
    EXPECT_EQ(end.kind == CampaignEnd::Kind::kCompleted, waits) << end.text << saboteur.said();
    EXPECT_NE((end.text + saboteur.said()).find(fault.words), std::string::npos)
        << end.text << saboteur.said();
    if (!waits) end = Run(folder, saboteur, fault.bench, true);
    EXPECT_EQ(end.kind, CampaignEnd::Kind::kCompleted) << end.text << saboteur.said();
    EXPECT_EQ(saboteur.stored(), 1);
    if (HasFailure()) return;
    std::cout << "| " << fault.name << " | " << phase.name << " | "
              << (waits ? "suspended, went on by itself" : "tripped, resumed to its end") << " |\n";
  }

  ScratchFolder scratch_;
};

TEST_F(FieldResume, BringsACampaignWithASilentDriveToItsEnd) { Check(Faults()[1], kPhases[1], false); }

class FieldResumeAtLength : public FieldResume, public testing::WithParamInterface<FaultInPhase> {};

TEST_P(FieldResumeAtLength, BringsACampaignToItsEnd) {
  const Fault& fault = Faults()[GetParam().fault];
  Check(fault, kPhases[GetParam().phase], fault.bench != TestedBench::kModbus);
}

INSTANTIATE_TEST_SUITE_P(Matrix, FieldResumeAtLength,
                         testing::ValuesIn(FaultsInPhases(kPhasesOfEveryCycle, IsOnlyAtLength)), NameOfCell);

}  // namespace
}  // namespace strainwave::bench::field_resume_test
