// SPDX-License-Identifier: Apache-2.0
// What `status` tells of a campaign that another process runs.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/simulation/campaign_program.h"
#include "tests/simulation/program.h"

namespace strainwave::status_command_test {
namespace {

TEST(StatusOfARunningCampaign, HasItsReadingsBesideTheirLimits) {
  const ScratchFolder scratch;
  const std::string folder = (scratch / "campaign").string();
  const pid_t process = StartProgram({"run", kSchedule, "--out", folder, "--pace", "20"}, scratch);
  WaitForPhase(folder, "load_run", process);
  nlohmann::json live;
  while (live.is_null()) {  // polling another process: nothing to wait on
    live = nlohmann::json::parse(RunProgram({"status", folder, "--json"}).out)["live"];
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const std::string words = RunProgram({"status", folder}).out;
  ::kill(process, SIGKILL);
  WaitForProgram(process, scratch);

  EXPECT_LT(live["age_s"].get<double>(), 60.0);
  EXPECT_EQ(live["utc"].get<std::string>().back(), 'Z');
  const auto& values = live["values"];
  ASSERT_EQ(values.size(), 4u);
  // As small.yaml has them.
  const std::pair<const char*, double> limits[] = {
      {"output torque", 60.0}, {"input speed", 3000.0}, {"gear temperature", 75.0}, {"vibration RMS", 50.0}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(values[i]["quantity"], limits[i].first);
    EXPECT_NEAR(values[i]["limit"].get<double>(), limits[i].second, 1e-9);
  }
  EXPECT_NE(words.find("  readings     "), std::string::npos) << words;

  EXPECT_TRUE(std::filesystem::exists(folder + "/readings")) << "a kill leaves it";
  const auto after = nlohmann::json::parse(RunProgram({"status", folder, "--json"}).out);
  EXPECT_EQ(after["running"], false);
  EXPECT_TRUE(after["live"].is_null()) << "of a process that is gone nothing is live";
}

}  // namespace
}  // namespace strainwave::status_command_test
