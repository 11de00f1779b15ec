// SPDX-License-Identifier: Apache-2.0
// A sensor whose plug is pulled in a campaign is named for as long as it lasts, with the reason.
#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/campaign.h"
#include "bench/campaign/campaign_runner.h"
#include "bench/machines/field/field_machine.h"
#include "tests/checkout.h"
#include "tests/schedules/schedule_text.h"
#include "tests/simulation/program.h"
#include "tests/simulation/until.h"

namespace strainwave::bench::field_bad_channels_test {
namespace {

CampaignInputs InputsIn(const ScratchFolder& scratch) {
  std::string text = schedules::With(schedules::GoodSchedule(), "cycles: 3", "cycles: 1");
  text.erase(text.find("phases:"));
  std::ofstream(scratch / "schedule.yaml") << text << R"(suspend:
  bad_sensor: 500 ms
  dwell: 500 ms
phases:
  - kind: load_run
    duration: 6 s
    output_torque: 30 Nm
    input_speed: 1200 rpm
    torque_rate: 200 Nm/s
    log_rate: 10 Hz
measurements:
  declared_temperature: 25 degC
  temperature_tolerance: 20 K
  repeatability_repeats: 0
)";
  return ReadInputs(scratch / "schedule.yaml",
                    std::filesystem::path(SourceFolder()) / "tests/simulation/field/bench.yaml");
}

/// Pulls the plug of the accelerometers in the load run, looks on as people do, and puts it back.
class Puller final : public ProgressSink {
 public:
  Puller(DeviceSide& devices, std::string folder) : devices_(devices), folder_(std::move(folder)) {}

  void Update(const ProgressState& state) override {
    if (state.phase != "load_run") return;
    if (++beats_ == 2) devices_.Do("stream accelerometers silent on");
    if (state.bad_channels.empty()) {
      is_gone_ = !seen_.empty();
      return;
    }
    seen_.assign(state.bad_channels.begin(), state.bad_channels.end());
    if (++beats_with_it_ != 3) return;  // also while the campaign is suspended for it
    status_ = RunProgram({"status", folder_, "--json"}).out;
    text_ = RunProgram({"status", folder_}).out;
    devices_.Do("stream accelerometers silent off");
  }
  void Message(std::string_view, std::string_view text) override { messages_.emplace_back(text); }
  void CycleStored(int, const std::vector<Result>&) override {}

  std::vector<ChannelTrouble> seen_;
  bool is_gone_{};
  std::string status_;
  std::string text_;
  std::vector<std::string> messages_;

 private:
  DeviceSide& devices_;
  std::string folder_;
  int beats_{};
  int beats_with_it_{};
};

TEST(BadChannels, AreNamedWhileTheyLast) {
  const ScratchFolder scratch;
  const CampaignInputs inputs = InputsIn(scratch);
  const CampaignFolder folder{scratch / "campaign"};
  Journal journal = CreateCampaign(folder, inputs);
  FieldMachine machine(inputs.bench, 80.0, {});
  Until([&] { return machine.Devices().sampler.Read().bad_channels == 0; });
  Puller puller(*machine.device_side(), folder.root.string());
  const std::atomic<StopRequest> request{StopRequest::kNone};
  CampaignRunner runner(HeldFolder(folder), inputs.schedule, inputs.bench, machine, journal, request, puller);
  const CampaignEnd end = runner.Run({});
  EXPECT_EQ(end.kind, CampaignEnd::Kind::kCompleted) << end.text;

  const std::vector<std::string> names{"accel_motor_z", "accel_x", "accel_y", "accel_z"};
  ASSERT_EQ(puller.seen_.size(), 4U);
  for (const ChannelTrouble& trouble : puller.seen_) {
    EXPECT_EQ(std::ranges::count(names, trouble.channel), 1) << trouble.channel;
    EXPECT_NE(trouble.reason.find("accelerometers: " + trouble.channel), std::string::npos) << trouble.reason;
    EXPECT_NE(trouble.reason.find("is silent: nothing came for"), std::string::npos) << trouble.reason;
  }
  // Another program sees the same meanwhile, in both shapes.
  const auto bad = nlohmann::json::parse(puller.status_).at("bad_channels");
  ASSERT_EQ(bad.size(), 4U);
  for (std::size_t i = 0; i < bad.size(); ++i) {
    EXPECT_EQ(bad[i].at("channel"), names[i]);
    EXPECT_NE(bad[i].at("reason").get<std::string>().find("is silent"), std::string::npos);
    EXPECT_TRUE(bad[i].at("since_utc").get<std::string>().ends_with("Z"));
    EXPECT_NE(puller.text_.find("BAD CHANNEL " + names[i] + " "), std::string::npos) << puller.text_;
  }
  // It is over as soon as samples come again.
  EXPECT_TRUE(puller.is_gone_);
  EXPECT_TRUE(journal.ChannelTroubles().empty());
  EXPECT_EQ(std::ranges::count(puller.messages_, "channel accel_x is good again"), 1);
}

}  // namespace
}  // namespace strainwave::bench::field_bad_channels_test
