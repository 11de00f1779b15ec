// SPDX-License-Identifier: Apache-2.0
// A limit that nothing on the bench measures: the program says so, and neither trips on it nor calls it
// watched.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/campaign/journal.h"
#include "bench/configuration/embedded_bench.h"
#include "tests/checkout.h"
#include "tests/simulation/program.h"

namespace strainwave::unwatched_limits_test {
namespace {

const std::string kSchedule = SourceFolder() + "/tests/simulation/small.yaml";

/// The embedded bench without its accelerometers, and a schedule that does without them.
class WithoutAccelerometers : public testing::Test {
 protected:
  WithoutAccelerometers() {
    std::string bench = bench::EmbeddedBenchText();
    const std::size_t accelerometers = bench.find("accelerometers:");
    bench.erase(accelerometers, bench.find("simulation:") - accelerometers);
    std::ofstream(bench_) << bench;
    std::string schedule = WholeFile(kSchedule);
    const std::size_t rotation = schedule.find("  - kind: measurement_rotation");
    schedule.erase(rotation, schedule.find("  - kind: transmission_error") - rotation);
    for (const auto& [from, to] : {std::pair{"duration: 20 min", "duration: 10 s"},
                                   {"cycles: 3", "cycles: 1"},
                                   {"vibration_rms: 50 m/s2", "vibration_rms: 0.001 m/s2"}}) {
      schedule.replace(schedule.find(from), std::string_view(from).size(), to);
    }
    std::ofstream(schedule_) << schedule;
  }

  const ScratchFolder scratch_;
  const std::string bench_ = (scratch_ / "bench.yaml").string();
  const std::string schedule_ = (scratch_ / "schedule.yaml").string();
  const std::string warning_ = schedule_ +
                               ":24:18: warning: vibration_rms = 0.001 m/s2 watches nothing: " + bench_ +
                               " has no accelerometers (expected one)\n";
};

TEST_F(WithoutAccelerometers, ValidateListsTheirLimitAsNotWatched) {
  const ProgramResult result = RunProgram({"validate", schedule_, "--bench", bench_});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.error, warning_);
  const std::size_t not_watched = result.out.find("not watched on this bench\n");
  ASSERT_NE(not_watched, std::string::npos) << result.out;
  EXPECT_GT(result.out.find("limits.vibration_rms                    the bench has no accelerometers\n"),
            not_watched);
  EXPECT_EQ(result.out.find("limits.vibration_rms"), result.out.rfind("limits.vibration_rms"));
  const auto plan =
      nlohmann::json::parse(RunProgram({"validate", schedule_, "--bench", bench_, "--json"}).out);
  std::vector<std::string> not_watched_limits;
  for (const auto& row : plan["interlocks"]) {
    if (!row["watched"])
      not_watched_limits.push_back(row["limit"].get<std::string>() + ": " +
                                   row["why_not"].get<std::string>());
  }
  EXPECT_EQ(not_watched_limits,
            (std::vector<std::string>{"limits.vibration_rms: the bench has no accelerometers",
                                      "pressed, or its pendant gone: the bench has no pendant"}));
}

TEST_F(WithoutAccelerometers, ValidateSaysAfterHowLongAnInterlockNoticesAndWhetherItLatches) {
  const ProgramResult result = RunProgram({"validate", schedule_, "--bench", bench_});
  EXPECT_NE(
      result.out.find("  output torque               limits.output_torque                           0.04 s  "
                      "latches  torque off, brakes on\n"),
      std::string::npos)
      << result.out;
  const auto plan =
      nlohmann::json::parse(RunProgram({"validate", schedule_, "--bench", bench_, "--json"}).out);
  std::map<std::string, std::pair<double, bool>> rows;
  for (const auto& row : plan["interlocks"]) rows[row["limit"]] = {row["noticed_within_s"], row["latches"]};
  // Three periods that a reading may be old, and the period in which it is looked at.
  EXPECT_EQ(rows.at("limits.output_torque"), std::pair(0.04, true));
  EXPECT_EQ(rows.at("power state fault"), std::pair(0.04, false));
  // small.yaml waits 2 s for a bad sensor.
  EXPECT_NEAR(rows.at("suspend.bad_sensor").first, 2.04, 1e-9);
}

// Nor does it trip, however low: what nothing measures says nothing.
TEST_F(WithoutAccelerometers, TheCampaignRunsAndItsJournalSaysWhatIsNotWatched) {
  const ProgramResult result =
      RunProgram({"run", schedule_, "--bench", bench_, "--out", (scratch_ / "campaign").string()});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_TRUE(result.error.starts_with(warning_)) << result.error;
  const auto journal =
      bench::Journal::Open(scratch_ / "campaign/campaign.db", bench::Database::Mode::kReadOnly);
  std::vector<std::string> told;
  for (const bench::Event& event : journal.Events(100)) {
    if (event.code == "interlocks") told.push_back(event.severity + ": " + event.text);
  }
  EXPECT_EQ(told, (std::vector<std::string>{
                      "warning: limits.vibration_rms watches nothing: the bench has no accelerometers"}));
}

}  // namespace
}  // namespace strainwave::unwatched_limits_test
