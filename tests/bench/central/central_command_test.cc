// SPDX-License-Identifier: Apache-2.0
// What the commands of `strainwave central` say and end with.
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include "tests/bench/central/lab.h"

namespace strainwave::bench::central_command_test {
namespace {

class CentralCommand : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
    lab_ = std::make_unique<Lab>();
    campaign_ = std::make_unique<WrittenCampaign>(lab_->scratch / "campaign");
    campaign_->AddCycles(12);
    admin_ = lab_->postgres.Conninfo("admin");
    std::ofstream(File()) << "x";
  }
  std::string File() const { return lab_->scratch / "file"; }
  // The last line of what it says, with its exit code.
  std::string Said(const std::vector<std::string>& words) const {
    const ProgramResult result = RunProgram(words);
    const std::string lines = result.error.substr(0, result.error.find_last_not_of('\n') + 1);
    return fmt::format("{} {}", result.exit_code, lines.substr(lines.rfind('\n') + 1));
  }
  std::unique_ptr<Lab> lab_;
  std::unique_ptr<WrittenCampaign> campaign_;
  std::string admin_;
};

TEST_F(CentralCommand, PathsThatCannotBeAreWrongInput) {
  lab_->Forward(lab_->Order(campaign_->folder()));
  const std::string none = lab_->scratch / "no/such/x";
  EXPECT_EQ(Said({"central", "fetch", "--server", admin_, "--out", File()}),
            fmt::format("2 {}: error: is no folder (expected a folder, there or to be made)", File()));
  EXPECT_EQ(
      Said({"central", "fetch", "--server", admin_, "--out", campaign_->folder().root.string()}),
      fmt::format("2 {}: error: is a campaign's folder, or lies in one (expected a folder for campaigns, one "
                  "below it for each)",
                  campaign_->folder().root.string()));
  EXPECT_EQ(Said({"central", "add-bench", "hall-5", "--server", admin_, "--passfile", none}),
            fmt::format("2 {}: error: its folder is not there (expected a file in a folder that is)", none));
  EXPECT_EQ(Said({"central", "forward", campaign_->folder().root.string(), "--server",
                  lab_->postgres.Conninfo("bench_hall-3"), "--store", File()}),
            fmt::format("2 {}: error: is no folder (expected a folder, there or to be made)", File()));
  EXPECT_EQ(Said({"life", "--from-server", admin_, "--plots", File()}),
            fmt::format("2 {}: error: is no folder (expected a folder, there or to be made)", File()));
  EXPECT_EQ(Said({"report", "--from-server", admin_, "--out", none}),
            fmt::format("2 {}: error: its folder is not there (expected a file in a folder that is)", none));
  const std::string longest(300, 'a');
  EXPECT_EQ(
      Said({"central", "fetch", "--server", admin_, "--out", lab_->scratch / "out", "--store", longest}),
      fmt::format("2 {}: error: File name too long (expected another path)", longest));
  EXPECT_EQ(Said({"central", "list", "--server", "service=nope"}),
            "2 service=nope: error: definition of service \"nope\" not found (expected a service of "
            "~/.pg_service.conf, or options that libpq knows)");
}

TEST_F(CentralCommand, MissingRecordsAreCountedAtTheEnd) {
  auto order = lab_->Order(campaign_->folder());
  order.settings.store = lab_->scratch / "store";
  lab_->Forward(order);
  const std::string digest = Sha256("records of cycle 1");
  const std::string store = order.settings.store;
  const std::string out = lab_->scratch / "fetched";
  std::filesystem::remove(order.settings.store / digest.substr(0, 2) / digest);
  EXPECT_EQ(
      Said({"central", "fetch", "--server", admin_, "--store", store, "--out", out}),
      fmt::format("1 {}: error: 1 of 12 raw records are missing (expected all; the folders are whole but for "
                  "them)",
                  store));
  EXPECT_EQ(Said({"central", "fetch", "--server", admin_, "--out", out + "2"}), "0 ");
}

TEST_F(CentralCommand, ACampaignOfTwoBenchesCountsOnce) {
  lab_->AddBench("hall-4");
  std::filesystem::copy(campaign_->folder().root, lab_->scratch / "copy",
                        std::filesystem::copy_options::recursive);
  lab_->Forward(lab_->Order(campaign_->folder()));
  lab_->Forward(lab_->Order({lab_->scratch / "copy"}, "hall-4"));
  const std::string identity = fmt::format("{:016x}", campaign_->journal().Identity()).substr(0, 8);
  const std::string listed = RunProgram({"central", "list", "--server", admin_}).out;
  EXPECT_NE(listed.find(fmt::format("  hall-3-{} again: life and report leave it out\n", identity)),
            listed.npos)
      << listed;
  const ProgramResult json = RunProgram({"central", "list", "--server", admin_, "--json"});
  EXPECT_NE(json.out.find(fmt::format("\"same_as\": \"hall-3-{}\"", identity)), json.out.npos) << json.out;
  EXPECT_NE(json.out.find("\"same_as\": null"), json.out.npos) << json.out;
  const std::string told = fmt::format(
      "hall-4-{0}: is the campaign hall-3-{0} again, forwarded by another bench: left out", identity);
  const ProgramResult life = RunProgram({"life", "--from-server", admin_, "--json"});
  EXPECT_EQ(life.exit_code, 0) << life.error;
  EXPECT_NE(life.out.find(told), life.out.npos) << life.out;
  EXPECT_NE(life.error.find("warning: " + told), life.error.npos) << life.error;
  const ProgramResult report =
      RunProgram({"report", "--from-server", admin_, "--json", "--out", lab_->scratch / "r.html"});
  EXPECT_EQ(report.exit_code, 0) << report.error;
  EXPECT_NE(report.out.find(told), report.out.npos) << report.out;
  EXPECT_EQ(report.out.find("/hall-4-"), report.out.npos) << report.out;
}

// Programs that go on until they are asked to end have done what they were asked for; what is cut short has
// not.
TEST_F(CentralCommand, EndsOnRequest) {
  const ScratchFolder said;
  const auto ended = [&](const std::vector<std::string>& words, const char* stream,
                         const std::string& begins) {
    const pid_t process = StartProgram(words, said);
    Until([&] { return WholeFile(said / stream).find(begins) != std::string::npos; });
    ::kill(process, SIGINT);
    const int code = WaitForProgram(process, said).exit_code;
    std::filesystem::remove(said / stream);
    return code;
  };
  const std::string folder = campaign_->folder().root;
  const std::string bench = lab_->postgres.Conninfo("bench_hall-3");
  EXPECT_EQ(ended({"central", "forward", folder, "--server", bench, "--follow"}, "stderr", "brought"), 0);
  EXPECT_EQ(ended({"central", "page", "--server", admin_, "--port", "0"}, "stdout", "all benches: "), 0);
  EXPECT_EQ(ended({"serve", folder, "--port", "0"}, "stdout", folder), 0);
  const std::string nobody = "host=" + (lab_->scratch / "nobody").string();
  EXPECT_EQ(
      ended({"central", "forward", folder, "--server", nobody, "--patience", "1e9"}, "stderr", "tried again"),
      130);
}

}  // namespace
}  // namespace strainwave::bench::central_command_test
