// SPDX-License-Identifier: Apache-2.0
// strainwave bench trip-test, as a person uses it.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/checkout.h"
#include "tests/simulation/program.h"

namespace strainwave::trip_command_test {
namespace {

using nlohmann::json;

const std::string kSource = SourceFolder();
const std::string kQuick = kSource + "/schedules/quick.yaml";
const std::string kInProcess = kSource + "/bench/examples/in_process.yaml";

TEST(TripTestCommand, PassesEveryRowOfTheSimulatedBench) {
  const ProgramResult result = RunProgram({"bench", "trip-test", "--schedule", kQuick, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.out << result.error;
  const json sheet = json::parse(result.out);
  EXPECT_EQ(sheet["good"], true);
  EXPECT_EQ(sheet["failed"], 0);
  EXPECT_EQ(sheet["skipped"], 1);
  EXPECT_EQ(sheet["passed"], 28);
  EXPECT_EQ(sheet["bench"], "embedded simulated bench");
  EXPECT_EQ(sheet["schedule"], kQuick);
  EXPECT_TRUE(sheet["software"].get<std::string>().starts_with("strainwave 0.1.0")) << sheet["software"];
  EXPECT_NE(result.error.find("row 1 of 29: output torque\n"), std::string::npos) << result.error;
}

TEST(TripTestCommand, PrintsASheetAndKeepsItOnce) {
  const ScratchFolder folder;
  const std::string file = (folder / "sheet.json").string();
  const std::vector<std::string> arguments{"bench", "trip-test", "--only", "twist_limit", "--out", file};
  const ProgramResult result = RunProgram(arguments);
  ASSERT_EQ(result.exit_code, 0) << result.out << result.error;
  for (const char* words : {"trip test of the interlocks\n  bench     embedded simulated bench, simulated\n",
                            "  limits    of no schedule\n", "  software  strainwave 0.1.0",
                            "passed   twist, input locked  30 arcmin (limits.twist)",
                            "\n1 row: 1 passed, 0 failed, 0 skipped\n"}) {
    EXPECT_NE(result.out.find(words), std::string::npos) << words << " is not in\n" << result.out;
  }
  EXPECT_EQ(json::parse(WholeFile(file))["rows"][0]["code"], "twist_limit");
  const ProgramResult again = RunProgram(arguments);
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_EQ(again.error,
            "--out " + file + ": error: the file is there already (expected a new name: a sheet is kept)\n");
}

TEST(TripTestCommand, NamesTheNearestCode) {
  const ProgramResult result = RunProgram({"bench", "trip-test", "--only", "twist_limits"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(result.error.starts_with(
      "--only twist_limits: error: no interlock has this code, did you mean 'twist_limit'? (expected "
      "output_torque_limit, "))
      << result.error;
}

TEST(TripTestCommand, WantsAScheduleForABenchOfMetal) {
  const ProgramResult result = RunProgram({"bench", "trip-test", kInProcess});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.error, kInProcess +
                              ": error: the limits of a bench of metal are a schedule's (expected --schedule "
                              "FILE)\n");
}

TEST(TripTestCommand, MovesNothingOfMetalThatNobodyHasConfirmed) {
  const ProgramResult result = RunProgram({"bench", "trip-test", kInProcess, "--schedule", kQuick});
  EXPECT_EQ(result.exit_code, 130) << result.error;
  EXPECT_NE(
      result.error.find("nobody has confirmed, nothing was moved (expected a person at the terminal, or "
                        "--yes)\n"),
      std::string::npos)
      << result.error;
}

}  // namespace
}  // namespace strainwave::trip_command_test
