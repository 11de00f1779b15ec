// SPDX-License-Identifier: Apache-2.0
// The schedules that come with the program, and the one in their README.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <variant>

#include "schedules/reader/plan.h"
#include "schedules/reader/read_schedule.h"
#include "schedules/reader/validate_schedule.h"
#include "tests/checkout.h"

namespace strainwave::schedules::schedule_files_test {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(SourceFolder()) / "schedules";

TEST(ScheduleFiles, AllLoadWithoutAWarning) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path().string());
    Schedule schedule;
    ASSERT_NO_THROW(schedule = ReadSchedule(entry.path()));
    EXPECT_EQ(schedule.name, entry.path().stem().string());
    for (const Finding& finding : ValidateSchedule(schedule).items()) {
      ADD_FAILURE() << FormatFinding(schedule.file_name, finding);
    }
    names.insert(schedule.name);
  }
  for (const char* name : {"paper", "quick", "run-in", "overload"}) EXPECT_TRUE(names.contains(name)) << name;
}

TEST(ScheduleFiles, PaperIsTheTestThatWasPublished) {
  const Schedule paper = ReadSchedule(kFolder / "paper.yaml");
  EXPECT_EQ(paper.cycles, 3500);
  EXPECT_EQ(paper.specimen.t1_Nm, 7.0);
  EXPECT_EQ(paper.specimen.t2_Nm, 25.0);
  EXPECT_EQ(paper.specimen.t3_Nm, 34.0);
  ASSERT_EQ(paper.phases.size(), 4U);
  EXPECT_EQ(std::get<LoadRun>(paper.phases[0].parameters).output_torque_Nm, 40.0);
  EXPECT_TRUE(std::get<MeasurementRotation>(paper.phases[1].parameters).clockwise);
  EXPECT_EQ(std::get<TransmissionErrorSweep>(paper.phases[2].parameters).steps, 360);
  EXPECT_EQ(std::get<HysteresisTest>(paper.phases[3].parameters).peak_torque_Nm, 34.0);
  const Plan plan = MakePlan(paper, {});
  EXPECT_NEAR(plan.load_s, 1750.0 * 3600.0, 1e-6);
}

TEST(ScheduleFiles, TheExampleOfTheReadmeLoadsAndItsDefaultsAreTheReaders) {
  std::ifstream file(kFolder / "README.md");
  const std::string readme{std::istreambuf_iterator<char>(file), {}};
  const std::string fence = "```yaml\n";
  const std::size_t begin = readme.find(fence);
  ASSERT_NE(begin, std::string::npos);
  const std::string text =
      readme.substr(begin + fence.size(), readme.find("```\n", begin + 1) - begin - fence.size());
  Schedule example;
  ASSERT_NO_THROW(example = ParseSchedule(text, "README.md"));

  // Take away every key of the phases that is not required, and the same schedule must be left.
  std::string bare;
  std::size_t from = 0;
  bool in_phases = false;
  while (from < text.size()) {
    const std::size_t end = text.find('\n', from);
    const std::string line = text.substr(from, end - from);
    from = end + 1;
    if (!line.starts_with(' ') && !line.empty())
      in_phases = line.starts_with("phases:") || line.starts_with("preparation:");
    const bool optional = in_phases && line.starts_with("    ") && line.find("required") == std::string::npos;
    if (!optional) bare += line + "\n";
  }
  const Schedule defaults = ParseSchedule(bare, "bare");
  ASSERT_EQ(defaults.phases.size(), example.phases.size());
  EXPECT_LT(bare.size(), text.size());
  for (const auto& [path, origin] : example.origins) {
    if (!path.starts_with("phases[") && !path.starts_with("preparation[")) continue;
    const auto other = defaults.origins.find(path);
    // Left out, these are not done at all.
    const bool has_no_default = path.ends_with(".record") || path.ends_with(".vibration_statistics");
    if (has_no_default) continue;
    ASSERT_NE(other, defaults.origins.end()) << path;
    EXPECT_EQ(other->second.text, origin.text) << path;
  }
}

}  // namespace
}  // namespace strainwave::schedules::schedule_files_test
