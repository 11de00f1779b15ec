// SPDX-License-Identifier: Apache-2.0
// What is done about alarms from a shell: of a campaign that has tripped, and of one that runs.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/simulation/campaign_program.h"
#include "tests/simulation/program.h"

namespace strainwave::alarms_command_test {
namespace {

nlohmann::json JsonOf(const std::vector<std::string>& arguments) {
  const ProgramResult result = RunProgram(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.error;
  return nlohmann::json::parse(result.out);
}

std::string Changed(const ScratchFolder& scratch, const std::string& from, const std::string& to) {
  std::string text = WholeFile(kSchedule);
  const std::string file = (scratch / "schedule.yaml").string();
  std::ofstream(file) << text.replace(text.find(from), from.size(), to);
  return file;
}

/// One campaign that its blank test has tripped, on the embedded bench with guidance.
class Tripped : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchFolder;
    schedule_ = Changed(*scratch_, "twist: 30 arcmin", "twist: 5 arcmin");
    bench_ = (*scratch_ / "bench.yaml").string();
    const auto embedded = *scratch_ / "embedded";
    RunProgram({"run", schedule_, "--out", embedded.string()});
    std::ofstream(bench_)
        << WholeFile(embedded / "bench.yaml")
        << "alarms:\n  - {interlock: twist_limit, guidance: look at the brake of the input}\n";
    result_ = RunProgram({"run", schedule_, "--bench", bench_, "--out", Original()});
  }
  static void TearDownTestSuite() { delete scratch_; }
  void SetUp() override {
    ASSERT_EQ(result_.exit_code, 1) << result_.error;
    std::filesystem::copy(Original(), folder_, std::filesystem::copy_options::recursive);
  }
  static std::string Original() { return (*scratch_ / "campaign").string(); }

  nlohmann::json Alarms(bool all = false) const {
    std::vector<std::string> arguments{"alarms", folder_, "--json"};
    if (all) arguments.push_back("--all");
    return JsonOf(arguments)["alarms"];
  }
  ProgramResult Do(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"alarms", folder_});
    return RunProgram(arguments);
  }

  static ScratchFolder* scratch_;
  static std::string schedule_;
  static std::string bench_;
  static ProgramResult result_;
  ScratchFolder own_;
  std::string folder_ = (own_ / "campaign").string();
};
ScratchFolder* Tripped::scratch_ = nullptr;
std::string Tripped::schedule_;
std::string Tripped::bench_;
ProgramResult Tripped::result_;

TEST_F(Tripped, IsListedAndShownByStatusWithWhatToDo) {
  const auto alarms = Alarms();
  ASSERT_EQ(alarms.size(), 1U);
  EXPECT_EQ(alarms[0]["number"], 1);
  EXPECT_EQ(alarms[0]["code"], "twist_limit");
  EXPECT_EQ(alarms[0]["state"], "raised");
  EXPECT_EQ(alarms[0]["priority"], "high");
  EXPECT_EQ(alarms[0]["first_out"], true);
  EXPECT_EQ(alarms[0]["guidance"], "look at the brake of the input");
  EXPECT_TRUE(alarms[0]["acknowledged"].is_null());
  EXPECT_EQ(JsonOf({"status", folder_, "--json"})["alarms"], alarms);
  const std::string words = "  ALARM 1 high, first out: unacknowledged\n    " +
                            alarms[0]["utc"].get<std::string>() + " " + alarms[0]["text"].get<std::string>() +
                            "\n    to do: look at the brake of the input\n";
  for (const char* command : {"alarms", "status"}) {
    const std::string out = RunProgram({command, folder_}).out;
    EXPECT_NE(out.find(words), std::string::npos) << out;
  }
}

TEST_F(Tripped, IsAcknowledgedByNameWithAComment) {
  const ProgramResult done =
      Do({"acknowledge", "1", "--by", " A. Meier ", "--comment", "on my\nway \x1b[2J"});
  ASSERT_EQ(done.exit_code, 0) << done.error;
  const auto alarm = Alarms().at(0);
  EXPECT_EQ(alarm["state"], "acknowledged");
  EXPECT_EQ(alarm["acknowledged"]["by"], "A. Meier");
  const std::string utc = alarm["acknowledged"]["utc"];
  EXPECT_EQ(done.out, "alarm 1: acknowledged " + utc + " by A. Meier\n");
  ASSERT_EQ(alarm["actions"].size(), 1U);
  EXPECT_EQ(alarm["actions"][0]["text"], "on my\nway \x1b[2J") << "kept as it was written";
  const std::string shown = Do({}).out;
  EXPECT_NE(shown.find(utc + " acknowledge by A. Meier: on my\\nway \\x1b[2J\n"), std::string::npos) << shown;
  EXPECT_EQ(shown.find('\x1b'), std::string::npos);
}

TEST_F(Tripped, IsShelvedUntilAStatedTimeAndTakenOff) {
  const ProgramResult done = Do({"shelve", "1", "--for", "30min", "--by", "A. Meier"});
  ASSERT_EQ(done.exit_code, 0) << done.error;
  const auto alarm = Alarms().at(0);
  EXPECT_EQ(alarm["state"], "shelved_raised");
  EXPECT_EQ(alarm["shelved"]["by"], "A. Meier");
  const std::string until = alarm["shelved"]["until_utc"];
  EXPECT_EQ(done.out, "alarm 1: shelved until " + until + " by A. Meier, unacknowledged\n");
  EXPECT_EQ(Do({"unshelve", "1", "--by", "B. Kurz"}).out, "alarm 1: unacknowledged\n");
  EXPECT_EQ(Alarms().at(0)["actions"].size(), 2U);
}

// As the specimen's limits latch, the alarm goes only when somebody says that the cause is mended.
TEST_F(Tripped, OutlivesTheResumeAndIsClearedWhenConfirmed) {
  ASSERT_EQ(Do({"acknowledge", "1", "--by", "A. Meier"}).exit_code, 0);
  EXPECT_EQ(RunProgram({"run", schedule_, "--bench", bench_, "--out", folder_, "--resume"}).exit_code, 1);
  const auto after = Alarms();
  ASSERT_EQ(after.size(), 2U) << "the second trip is an alarm of its own";
  EXPECT_EQ(after[0]["state"], "latched");
  EXPECT_EQ(after[0]["acknowledged"]["by"], "A. Meier");
  EXPECT_EQ(after[1]["state"], "raised");
  EXPECT_EQ(after[1]["first_out"], true);
  ASSERT_EQ(Do({"confirm", "1", "--by", "B. Kurz", "--comment", "brake adjusted"}).exit_code, 0);
  EXPECT_EQ(Alarms().size(), 1U);
  const auto all = Alarms(true);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0]["state"], "cleared");
  EXPECT_EQ(all[0]["confirmed"]["by"], "B. Kurz");
}

TEST_F(Tripped, BadInputIsRefusedWithWhatWasExpected) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong{
      {{"acknowledge", "7", "--by", "A. Meier"},
       folder_ + ": error: there is no alarm 7 (expected a number from 1 to 1)\n"},
      {{"acknowledge", "-1", "--by", "A. Meier"},
       "acknowledge: error: '-1' is no number of an alarm (expected one that strainwave alarms " + folder_ +
           " shows)\n"},
      {{"acknowledge", "--by", "A. Meier"},
       "acknowledge: error: '' is no number of an alarm (expected one that strainwave alarms " + folder_ +
           " shows)\n"},
      {{"acknowledge", "1"},
       "--by: error: there is no name (expected whose act it is, as in --by \"A. Meier\")\n"},
      {{"acknowledge", "1", "--by", " \t"},
       "--by: error: there is no name (expected whose act it is, as in --by \"A. Meier\")\n"},
      {{"acknowledge", "1", "--by", std::string(101, 'a')},
       "--by: error: the name has 101 bytes (expected at most 100)\n"},
      {{"comment", "1", "--by", "A. Meier"},
       "--comment: error: there are no words (expected what is to be kept)\n"},
      {{"shelve", "1", "--by", "A. Meier"},
       "shelve: error: --for is missing (expected how long, as in --for 30min)\n"},
      {{"shelve", "1", "--by", "A. Meier", "--for", "25 h"},
       "error: an alarm cannot be shelved for 90000 s (expected more than 0 s and at most 24 h)\n"},
      {{"acknowledge", "1", "--by", "A. Meier", "--for", "1 h"},
       "--for 1 h: error: acknowledge takes no time (expected it with shelve alone)\n"},
      {{"confirm", "1", "--by", "A. Meier"},
       folder_ + ": error: alarm 1 cannot be confirmed: it is unacknowledged (expected one that is latched: "
                 "returned and acknowledged)\n"}};
  for (const auto& [arguments, message] : wrong) {
    const ProgramResult result = Do(arguments);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_EQ(result.error, message);
    EXPECT_EQ(result.out, "");
  }
  const auto alarm = Alarms().at(0);
  EXPECT_EQ(alarm["state"], "raised");
  EXPECT_TRUE(alarm["actions"].empty());
  EXPECT_EQ(RunProgram({"alarms", own_.path().string()}).exit_code, 2) << "no campaign";
}

TEST_F(Tripped, NotesOfPeopleAreKeptAndShown) {
  const ProgramResult done = RunProgram({"note", folder_, "<b>grease</b>\nchanged", "--by", "A. Meier"});
  ASSERT_EQ(done.exit_code, 0) << done.error;
  const auto notes = JsonOf({"status", folder_, "--json"})["notes"];
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0]["author"], "A. Meier");
  EXPECT_EQ(notes[0]["text"], "<b>grease</b>\nchanged");
  const std::string shown = RunProgram({"status", folder_}).out;
  EXPECT_NE(shown.find("  note         " + notes[0]["utc"].get<std::string>() +
                       " A. Meier: <b>grease</b>\\nchanged\n"),
            std::string::npos)
      << shown;
  EXPECT_EQ(RunProgram({"note", folder_, "x"}).error,
            "--by: error: there is no name (expected whose act it is, as in --by \"A. Meier\")\n");
  EXPECT_EQ(RunProgram({"note", folder_, " ", "--by", "A. Meier"}).error,
            "TEXT: error: there are no words (expected what is to be kept)\n");
}

TEST(ARunningCampaign, TakesNotesAndAcknowledgements) {
  const ScratchFolder scratch;
  const std::string schedule = Changed(scratch, "twist: 30 arcmin", "twist: 5 arcmin");
  const std::string folder = (scratch / "campaign").string();
  ASSERT_EQ(RunProgram({"run", schedule, "--out", folder}).exit_code, 1);
  // So slow that it is far from tripping again.
  const pid_t process =
      StartProgram({"run", schedule, "--out", folder, "--resume", "--pace", "0.02"}, scratch);
  while (nlohmann::json::parse(RunProgram({"status", folder, "--json"}).out)["running"] != true) {
  }
  EXPECT_EQ(RunProgram({"alarms", folder, "acknowledge", "1", "--by", "A. Meier"}).exit_code, 0);
  EXPECT_EQ(RunProgram({"note", folder, "beside it", "--by", "A. Meier"}).exit_code, 0);
  const auto status = nlohmann::json::parse(RunProgram({"status", folder, "--json"}).out);
  ::kill(process, SIGINT);
  const ProgramResult ended = WaitForProgram(process, scratch);
  EXPECT_EQ(ended.exit_code, 130) << ended.error;
  EXPECT_EQ(status["running"], true);
  ASSERT_EQ(status["alarms"].size(), 1U);
  ASSERT_EQ(status["notes"].size(), 1U);
  EXPECT_EQ(status["alarms"][0]["acknowledged"]["by"], "A. Meier");
  EXPECT_EQ(status["notes"][0]["text"], "beside it");
}

}  // namespace
}  // namespace strainwave::alarms_command_test
