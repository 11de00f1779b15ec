// SPDX-License-Identifier: Apache-2.0
// What `recompute` says of numbers that are not there, and what its pictures are called.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <iterator>
#include <regex>
#include <set>

#include "tests/simulation/campaign_program.h"
#include "tests/simulation/program.h"

namespace strainwave::recompute_command_test {
namespace {

bool SaysNotANumber(const ProgramResult& result) {
  static const std::regex nan("(^|[^a-z_/.])-?nan([^a-z_/.]|$)", std::regex::icase);
  return std::regex_search(result.out + result.error, nan);
}

// A loop to 17 Nm, of a gear whose T2 is 25 Nm: of K3 it says nothing.
TEST(RecomputeOfAShortLoop, SaysThatANumberIsNotThere) {
  const ScratchFolder scratch;
  const std::string loop = (scratch / "loop.csv").string();
  ASSERT_EQ(RunProgram({"simulate", "hysteresis", "--out", loop}).exit_code, 0);
  std::istringstream whole(WholeFile(loop));
  const std::string half = (scratch / "half.csv").string();
  std::ofstream file(half);
  for (std::string line; std::getline(whole, line);) {
    double time_s{}, torque_Nm{}, angle_deg{};
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &time_s, &torque_Nm, &angle_deg) == 3) {
      file << time_s << ',' << 0.5 * torque_Nm << ',' << 0.5 * angle_deg << '\n';
    } else {
      file << line << '\n';
    }
  }
  file.close();
  for (const char* method : {"model", "loading", "backbone"}) {
    const ProgramResult text = RunProgram({"recompute", half, "--method", method});
    EXPECT_EQ(text.exit_code, 1) << text.error;
    EXPECT_FALSE(SaysNotANumber(text)) << text.out;
    EXPECT_TRUE(std::regex_search(text.out, std::regex("\n  k3_Nm_per_rad +–\n"))) << text.out;
    const ProgramResult document = RunProgram({"recompute", half, "--method", method, "--json"});
    EXPECT_TRUE(nlohmann::json::parse(document.out)["k3_Nm_per_rad"].is_null());
  }
  EXPECT_FALSE(SaysNotANumber(RunProgram({"diagnose", half})));
}

TEST(RecomputeOfACampaign, GivesEachRecordAPictureWhichIsListed) {
  const ScratchFolder scratch;
  const std::string campaign = (scratch / "campaign").string();
  ASSERT_EQ(RunProgram({"run", kSchedule, "--out", campaign}).exit_code, 0);
  const std::string into = (scratch / "pictures").string();
  const std::string cycles = campaign + "/cycles/";
  const ProgramResult result =
      RunProgram({"recompute", cycles + "000001.h5", cycles + "000002.h5", campaign, "--plots", into});
  std::set<std::string> listed;
  const std::regex line("picture: (.*)\\.svg \\(and \\.png\\)\n");
  for (std::sregex_iterator it(result.out.begin(), result.out.end(), line), end; it != end; ++it) {
    listed.insert(std::filesystem::path((*it)[1].str()).filename());
  }
  const std::set<std::string> expected{"campaign_cycle_1_hysteresis_1_lock_0deg",
                                       "campaign_cycle_1_hysteresis_2_lock_90deg",
                                       "campaign_cycle_1_transmission_error",
                                       "campaign_cycle_2_hysteresis_1_lock_0deg",
                                       "campaign_cycle_2_hysteresis_2_lock_90deg",
                                       "campaign_cycle_2_transmission_error",
                                       "campaign_cycles_1_and_3_hysteresis_lock_0deg",
                                       "campaign_cycles_1_and_3_transmission_error",
                                       "campaign_cycles_1_to_3_trends"};
  EXPECT_EQ(listed, expected) << result.out << result.error;
  for (const std::string& name : expected) {
    EXPECT_TRUE(std::filesystem::exists(into + "/" + name + ".svg")) << name;
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(into), std::filesystem::directory_iterator{}),
            18);
}

}  // namespace
}  // namespace strainwave::recompute_command_test
