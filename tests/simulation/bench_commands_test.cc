// SPDX-License-Identifier: Apache-2.0
// strainwave devices, bench check, bench jog, bench commission and the end of a bench trip-test, as a person
// uses them, on devices within the program.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/checkout.h"
#include "tests/simulation/program.h"

namespace strainwave::bench_commands_test {
namespace {

using nlohmann::json;

const std::string kSource = SourceFolder();
const std::string kInProcess = kSource + "/bench/examples/in_process.yaml";
// The same with patience for machines that have other work to do.
const std::string kPatientBench = kSource + "/tests/simulation/field/bench.yaml";

// For a copy of the file in another folder.
std::string PatientBenchFromAnywhere() {
  std::string text = WholeFile(kPatientBench);
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
  };
  replace("../../../", kSource + "/");
  replace("profile: drive.yaml", "profile: " + kSource + "/tests/simulation/field/drive.yaml");
  return text;
}

TEST(DevicesCommand, ListsWhatABenchFileNames) {
  const ProgramResult result = RunProgram({"devices", kInProcess, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const json found = json::parse(result.out);
  const json& nodes = found["can"]["devices"];
  ASSERT_GE(nodes.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(nodes[i]["where"], "in_process, node " + std::to_string(i + 1));
    EXPECT_EQ(nodes[i]["what"], "servo drive (CiA 402)");
    EXPECT_EQ(nodes[i]["vendor"], "00005357h");
    EXPECT_EQ(nodes[i]["product"], "00000402h");
    EXPECT_EQ(nodes[i]["serial"], "00000001h");
    EXPECT_TRUE(nodes[i]["profile"].get<std::string>().ends_with("strainwave_drive.yaml")) << nodes[i];
  }
  ASSERT_EQ(found["modbus"]["devices"].size(), 1U);
  EXPECT_EQ(found["modbus"]["devices"][0]["unit"], 1);
  for (const char* part : {"can", "modbus", "hid", "iio", "camera"}) {
    EXPECT_FALSE(found[part]["devices"].empty() && found[part]["notes"].empty())
        << part << ": neither a device nor a reason";
  }
}

TEST(CheckCommand, ShowsWhatEveryDriveSaysOfItself) {
  const ProgramResult text = RunProgram({"bench", "check", kPatientBench});
  EXPECT_EQ(text.exit_code, 0) << text.out << text.error;
  for (const char* words :
       {"good  can ", "good  driving servo, node 1        disabled\n",
        "good  load servo, node 2           disabled\n", "        brake                     on\n",
        "        safe_torque_off           closed\n",
        "        identity                  vendor 00005357h, product 00000402h, revision "
        "00010000h, serial 00000001h\n",
        "good  thermometers                 connected\n", "good  input_angle_deg",
        "everything answers; nothing was moved\n"}) {
    EXPECT_NE(text.out.find(words), std::string::npos) << words << " is not in\n" << text.out;
  }
  const ProgramResult result = RunProgram({"bench", "check", kPatientBench, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.out << result.error;
  const json check = json::parse(result.out);
  EXPECT_EQ(check["good"], true);
  EXPECT_EQ(check["channels"].size(), 8U);
  std::size_t drives = 0;
  for (const json& device : check["devices"]) {
    if (device["device"].get<std::string>().find(" servo, node ") == std::string::npos) continue;
    ++drives;
    EXPECT_EQ(device["state"], "disabled") << device;
    EXPECT_EQ(device["brake"], "on") << device;
    EXPECT_EQ(device["safe_torque_off"], "closed") << device;
    EXPECT_EQ(device["identity"],
              "vendor 00005357h, product 00000402h, revision 00010000h, serial 00000001h");
  }
  EXPECT_EQ(drives, 2U);
}

TEST(CheckCommand, NamesADeviceThatIsNotThere) {
  const ScratchFolder folder;
  const std::string bench = (folder / "bench.yaml").string();
  std::string text = PatientBenchFromAnywhere();
  // Nobody plays an input with such a number.
  std::string input = WholeFile(kSource + "/bench/devices/profiles/hid_sto_contact.yaml");
  input.replace(input.find("\"5703\""), 6, "\"57FE\"");
  std::ofstream(folder / "contact.yaml") << input;
  text.insert(text.find("devices:\n") + 9, "  - {name: contact, kind: sto_contact, profile: contact.yaml}\n");
  std::ofstream(bench) << text;
  const ProgramResult shown = RunProgram({"bench", "check", bench});
  EXPECT_EQ(shown.exit_code, 3) << shown.error;
  for (const char* words :
       {"BAD   safe torque off contact      not plugged in\n", "good  driving servo, node 1 ",
        "not everything is as it should be (see BAD above); nothing was moved\n"}) {
    EXPECT_NE(shown.out.find(words), std::string::npos) << words << " is not in\n" << shown.out;
  }
  const ProgramResult result = RunProgram({"bench", "check", bench, "--json"});
  EXPECT_EQ(result.exit_code, 3) << result.error;
  const json check = json::parse(result.out);
  EXPECT_EQ(check["good"], false);
  for (const json& device : check["devices"]) {
    EXPECT_EQ(device["good"], device["device"] != "safe torque off contact") << device;
  }
}

TEST(DevicesCommand, RefusesWhatItCannotUse) {
  const ProgramResult units = RunProgram({"devices", "--units", "0-5"});
  EXPECT_EQ(units.exit_code, 2);
  EXPECT_EQ(units.error,
            "error: --units 0-5 is not usable (expected one unit or FIRST-LAST, from 1 to 247)\n");
  const ProgramResult address = RunProgram({"devices", "--modbus", "10.0.0.1"});
  EXPECT_EQ(address.exit_code, 2);
  EXPECT_EQ(address.error, "error: address = 10.0.0.1 (expected tcp:HOST:PORT or rtu:PATH:BAUD:8E1)\n");
}

// The program with a hand on its input.
class Handled {
 public:
  explicit Handled(const std::string& arguments)
      : input_(::popen(("exec " + ProgramPath() + " " + arguments + " >" + (folder_ / "stdout").string() +
                        " 2>" + (folder_ / "stderr").string())
                           .c_str(),
                       "w")) {
    // A program that ends before its keys do is for the test to tell.
    ::signal(SIGPIPE, SIG_IGN);
  }
  std::string said() const { return WholeFile(folder_ / "stderr"); }
  // Enter, again and again, as a key repeats. The test's own time-out ends it where that never comes.
  template <typename Condition>
  void HoldUntil(Condition condition) {
    while (!condition() && std::fputs("\n", input_) >= 0 && std::fflush(input_) == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  void Type(const std::string& keys) {
    std::fputs(keys.c_str(), input_);
    std::fflush(input_);
  }
  void WaitUntil(const std::string& words) {
    while (said().find(words) == std::string::npos)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ProgramResult End() {
    const int status = ::pclose(input_);
    return {WEXITSTATUS(status), WholeFile(folder_ / "stdout"), said()};
  }

 private:
  ScratchFolder folder_;
  std::FILE* input_;
};

// The newest figure before these words.
double Turned_deg(const std::string& text) {
  const std::size_t end = text.rfind(" deg");
  if (end == std::string::npos) return 0.0;
  const std::size_t begin = text.find_last_of(" \n", end - 1);
  return std::stod(text.substr(begin == std::string::npos ? 0 : begin + 1));
}

TEST(JogCommand, TurnsTheShaftWhileItIsHeldAndEndsSafeWithTheInput) {
  Handled jogging("bench jog " + kPatientBench + " --drive driving --speed '10 rpm'");
  jogging.WaitUntil("is held");
  jogging.HoldUntil([&] { return Turned_deg(jogging.said()) > 30.0; });
  const ProgramResult result = jogging.End();
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_GT(Turned_deg(result.out), 30.0) << result.out << result.error;
  EXPECT_NE(result.out.find("torque is off, the brakes are on"), std::string::npos) << result.out;
}

TEST(JogCommand, TurnsTheLoadWhichTurnsTheGearFromBehind) {
  Handled jogging("bench jog " + kPatientBench + " --drive load --speed '-1 rpm' --torque '30 Nm'");
  jogging.WaitUntil("is held");
  jogging.HoldUntil([&] { return Turned_deg(jogging.said()) < -3.0; });
  const ProgramResult result = jogging.End();
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_LT(Turned_deg(result.out), -3.0) << result.out << result.error;
  EXPECT_NE(result.out.find("torque is off, the brakes are on"), std::string::npos) << result.out;
}

TEST(JogCommand, TurnsNothingThatIsNotHeld) {
  Handled jogging("bench jog " + kPatientBench + " --drive load --speed '-0.2 rpm'");
  jogging.WaitUntil("deg turned");
  const ProgramResult result = jogging.End();
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NEAR(Turned_deg(result.out), 0.0, 0.01) << result.out;
}

TEST(RunCommand, TakesABenchFileByItsBareNameInItsOwnFolder) {
  const ScratchFolder scratch;
  std::ofstream(scratch / "bench.yaml") << PatientBenchFromAnywhere();
  std::string schedule = WholeFile(kSource + "/tests/simulation/small.yaml");
  schedule.erase(schedule.find("preparation:"));
  std::ofstream(scratch / "schedule.yaml") << schedule << R"(phases:
  - {kind: soak, below_temperature: 60 degC, at_most: 1 s}
measurements:
  declared_temperature: 25 degC
)";
  const ProgramResult result =
      RunProgram({"run", "schedule.yaml", "--bench", "bench.yaml", "--out", "C"}, scratch.path());
  EXPECT_EQ(result.exit_code, 0) << result.error;
}

TEST(JogCommand, RefusesWhatIsNotSlowOrTooStrongForTheBench) {
  const ProgramResult fast =
      RunProgram({"bench", "jog", kInProcess, "--drive", "driving", "--speed", "301 rpm"});
  EXPECT_EQ(fast.exit_code, 2);
  EXPECT_EQ(fast.error,
            "--speed 301 rpm: error: not a speed to jog the driving servo at (expected up to 300 rpm, 5 % of "
            "its peak speed at the axis; negative for the other direction)\n");
  const ProgramResult strong =
      RunProgram({"bench", "jog", kInProcess, "--drive", "load", "--torque", "101 Nm"});
  EXPECT_EQ(strong.exit_code, 2);
  EXPECT_EQ(strong.error,
            "--torque 101 Nm: error: not a limit for this bench (expected above 0 and up to 100 Nm, the "
            "range of its torque transducer)\n");
}

TEST(RunCommand, WritesDownWhatGoesOverTheBus) {
  const ScratchFolder folder;
  const std::filesystem::path logs = folder / "campaign/can";
  const pid_t process = StartProgram({"run", kSource + "/tests/simulation/small.yaml", "--bench", kInProcess,
                                      "--out", (folder / "campaign").string()},
                                     folder);
  std::filesystem::path log;
  for (int i = 0; i < 6000 && log.empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (!std::filesystem::exists(logs)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(logs)) {
      if (entry.file_size() > 50'000) log = entry.path();
    }
  }
  ::kill(process, SIGINT);
  const ProgramResult result = WaitForProgram(process, folder);
  EXPECT_EQ(result.exit_code, 130) << result.error;
  EXPECT_NE(result.error.find(
                "driving_servo: how long it takes to stop when this program is gone was never measured"),
            std::string::npos)
      << result.error;
  ASSERT_FALSE(log.empty()) << result.error;
  const std::string read =
      "/usr/bin/python3 -c \"import can, sys; ids = {m.arbitration_id for m in "
      "can.CanutilsLogReader(sys.argv[1])}; "
      "sys.exit(not {0x80, 0x201, 0x202} <= ids)\" " +
      log.string();
  EXPECT_EQ(std::system(read.c_str()), 0);
}

TEST(TripTestCommand, FilesWhyAPersonLeftARowOut) {
  Handled testing("bench trip-test " + kPatientBench + " --schedule " + kSource +
                  "/tests/vm/campaign/pendant.yaml --only drive_silent");
  testing.Type("\n");  // the shafts are clear
  testing.Type("cabinet locked \xff\n");
  testing.Type("no time\n");
  const ProgramResult result = testing.End();
  EXPECT_EQ(result.exit_code, 1) << "nothing was tested\n" << result.error;
  EXPECT_NE(
      result.error.find("age of a drive's state, load servo: get ready to pull the bus cable of the load "
                        "servo, while the bench stands still, then press Enter; or write why not"),
      std::string::npos)
      << result.error;
  EXPECT_NE(result.out.find("cabinet locked \\xff\n"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("no time\n\n2 rows: 0 passed, 0 failed, 2 skipped\n"), std::string::npos)
      << result.out;
}

TEST(TripTestCommand, EndsSafeOnCtrlCAndSaysWhatIsLeft) {
  const ScratchFolder folder;
  const pid_t process = StartProgram({"bench", "trip-test", kPatientBench, "--schedule",
                                      kSource + "/tests/vm/campaign/pendant.yaml", "--yes"},
                                     folder);
  // The test's own time-out ends it where that never comes.
  while (WholeFile(folder / "stderr").find("row 1 of ") == std::string::npos) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ::kill(process, SIGINT);
  const ProgramResult result = WaitForProgram(process, folder);
  EXPECT_EQ(result.exit_code, 130) << result.error;
  EXPECT_NE(result.out.find("stopped on request"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("the test was stopped before"), std::string::npos) << result.out;
}

TEST(CommissionCommand, RefusesWhatIsNoQuantityAndWhatTheBenchCannotMeasure) {
  const ProgramResult fast = RunProgram({"bench", "commission", kInProcess, "--yes", "--speed", "fast"});
  EXPECT_EQ(fast.exit_code, 2);
  EXPECT_EQ(fast.error,
            "--speed fast: error: not a number with a unit (expected a speed, as in '2400 rpm')\n");
  const ProgramResult strong = RunProgram({"bench", "commission", kInProcess, "--yes", "--torque", "101 Nm"});
  EXPECT_EQ(strong.exit_code, 2);
  EXPECT_EQ(
      strong.error,
      "--torque 101 Nm: error: not a limit for this bench (expected above 0 and up to 100 Nm, the range "
      "of its torque transducer)\n");
}

TEST(RunCommand, GoesOnWithALoadRunThatWasStopped) {
  const ScratchFolder folder;
  const std::string campaign = (folder / "campaign").string();
  const std::vector<std::string> first{
      "run", kSource + "/tests/vm/campaign/pendant.yaml", "--bench", kPatientBench, "--out", campaign};
  const pid_t process = StartProgram(first, folder);
  // The test's own time-out ends it where that never comes.
  while (WholeFile(folder / "stderr").find("load_run") == std::string::npos) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ::kill(process, SIGINT);
  const ProgramResult stopped = WaitForProgram(process, folder);
  EXPECT_EQ(stopped.exit_code, 130) << stopped.error;
  std::vector<std::string> again = first;
  again.emplace_back("--resume");
  const ProgramResult resumed = RunProgram(again);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.error;
  const json status = json::parse(RunProgram({"status", campaign, "--json"}).out);
  EXPECT_EQ(status["cycles_complete"], 1);
}

TEST(CommissionCommand, MeasuresKeepsAndShowsTheTimeToStop) {
  const ScratchFolder folder;
  const std::filesystem::path bench = folder / "bench.yaml";
  std::ofstream(bench) << PatientBenchFromAnywhere();
  const ProgramResult unasked = Handled("bench commission " + bench.string()).End();
  EXPECT_EQ(unasked.exit_code, 130) << "nobody said yes: standard input is at its end";
  EXPECT_FALSE(std::filesystem::exists(folder / "bench.commissioned.yaml"));

  const ProgramResult result = RunProgram({"bench", "commission", bench.string(), "--yes", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.error << result.out;
  const json measured = json::parse(result.out)["drives"];
  ASSERT_EQ(measured.size(), 2U);
  for (const json& drive : measured) {
    EXPECT_NE(drive["identity"].get<std::string>().find("serial 00000001h"), std::string::npos);
    // 14xxh:05 is 300 ms in the drives' profile; the rest is how this machine keeps its periods.
    EXPECT_GT(drive["left_enabled_s"].get<double>(), 0.25);
    EXPECT_LE(drive["left_enabled_s"].get<double>(), 2.0);  // longest_stop_time
  }
  const ProgramResult check = RunProgram({"bench", "check", bench.string()});
  EXPECT_NE(check.out.find("driving_servo, time to stop"), std::string::npos) << check.out;
  EXPECT_EQ(check.out.find("was never measured"), std::string::npos) << check.out;

  // Another drive in its place: no campaign.
  std::string record = WholeFile(folder / "bench.commissioned.yaml");
  record.replace(record.find("serial 00000001h"), 16, "serial 00000009h");
  std::ofstream(folder / "bench.commissioned.yaml") << record;
  const ProgramResult run = RunProgram({"run", kSource + "/tests/simulation/small.yaml", "--bench",
                                        bench.string(), "--out", (folder / "campaign").string()});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.error.find(
                "error: driving_servo: the time to stop was measured on another drive: vendor 00005357h, "
                "product 00000402h, revision 00010000h, serial 00000009h (this one is vendor 00005357h, "
                "product 00000402h, revision 00010000h, serial 00000001h; measure it with strainwave bench "
                "commission)\n"),
            std::string::npos)
      << run.error;
}

}  // namespace
}  // namespace strainwave::bench_commands_test
