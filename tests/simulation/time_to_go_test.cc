// SPDX-License-Identifier: Apache-2.0
// The time to go of a campaign that runs, against the time that it then took.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <string>

#include "bench/campaign/journal.h"
#include "tests/simulation/campaign_program.h"
#include "tests/simulation/program.h"

namespace strainwave::time_to_go_test {
namespace {

// Cycles of a load run and a lock test, which the plan takes for longer or shorter than they are.
std::string Schedule(const ScratchFolder& scratch, int cycles) {
  std::string text = WholeFile(kSchedule);
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("cycles: 3", "cycles: " + std::to_string(cycles));
  replace("20 min", "2 min");
  text.erase(text.find("  - kind: measurement_rotation"),
             text.find("  - kind: hysteresis") - text.find("  - kind: measurement_rotation"));
  replace("lock_angles: [0 deg, 90 deg]", "lock_angles: [0 deg]");
  const std::string file = (scratch / "schedule.yaml").string();
  std::ofstream(file) << text;
  return file;
}

TEST(TimeToGo, IsRightToOnePercentAfterFiftyCycles) {
  constexpr int kCycles = 80;
  const ScratchFolder scratch;
  const std::string folder = (scratch / "campaign").string();
  const ScratchFolder said;
  const pid_t process = StartProgram({"run", Schedule(scratch, kCycles), "--out", folder}, said);
  nlohmann::json seen{{"cycles_complete", 0}};
  while (seen["cycles_complete"] < 50) {
    const ProgramResult status = RunProgram({"status", folder, "--json"});
    if (status.exit_code == 0) seen = nlohmann::json::parse(status.out);
  }
  const ProgramResult run = WaitForProgram(process, said);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  ASSERT_LT(seen["cycles_complete"], kCycles - 5) << "seen too late to tell anything";
  const auto journal = bench::Journal::Open(folder + "/campaign.db", bench::Database::Mode::kReadOnly);
  const double took_s = journal.Cycles().back().ended_s - seen["bench_time_s"].get<double>();
  EXPECT_NEAR(seen["eta_s"].get<double>(), took_s, 0.01 * took_s);
}

}  // namespace
}  // namespace strainwave::time_to_go_test
