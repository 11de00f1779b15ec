// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_file.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"

namespace strainwave::bench::notice_file_test {
namespace {

constexpr Moment kThen{1'793'613'600'000, 3'600'000, 0xffff'ffff'ffff'fff0U};

NoticeState Full() {
  NoticeState state;
  NoticeMemory& memory = state.memory;
  memory.alarms = {{{3, "twist_limit", "a \x1b text", AlarmPriority::kHigh, 4, "load_run", "2026"},
                    kThen,
                    true,
                    kThen,
                    {}}};
  memory.silence = {kThen, true};
  memory.ended_run = "run-1";
  memory.run = "run-2";
  memory.view = BenchView::kInterrupted;
  memory.since = kThen;
  memory.sent = {kThen, kThen};
  memory.last_number = 17;
  Notice notice;
  notice.id = "1-2";
  notice.kind = NoticeKind::kEscalation;
  notice.audience = Audience::kSecond;
  notice.subject = "Δ";
  notice.alarms = {memory.alarms[0].alarm};
  state.outbox.waiting = {{notice, kThen, {"mail", "mqtt"}, 3}};
  state.outbox.channels = {{"mail", 2, kThen, "no server"}, {"mqtt", 0, {}, ""}};
  return state;
}

class NoticeFile : public testing::Test {
 protected:
  NoticeFile() { std::filesystem::create_directories(folder_.root); }
  ~NoticeFile() override { std::filesystem::remove_all(folder_.root); }

  CampaignFolder folder_{std::filesystem::temp_directory_path() /
                         ("notice_file_" + std::to_string(::getpid()))};
  std::string trouble_;
};

TEST_F(NoticeFile, HoldsAllThatWasKept) {
  const std::string before = NoticeStateJson(Full()).dump();
  WriteNoticeFile(NoticeFileOf(folder_), Full());
  const NoticeState read = ReadNoticeFile(NoticeFileOf(folder_), trouble_);
  EXPECT_EQ(trouble_, "");
  EXPECT_EQ(NoticeStateJson(read).dump(), before);
  EXPECT_EQ(read.memory.since.boot, kThen.boot);
  EXPECT_EQ(read.outbox.waiting.at(0).notice.audience, Audience::kSecond);
}

TEST_F(NoticeFile, ThatIsNotThereIsAnEmptyOne) {
  EXPECT_TRUE(ReadNoticeFile(NoticeFileOf(folder_), trouble_).memory.alarms.empty());
  EXPECT_EQ(trouble_, "");
}

TEST_F(NoticeFile, ThatIsDamagedIsToldAndBegunAnew) {
  std::string whole = NoticeStateJson(Full()).dump();
  for (const std::string& text : {std::string(), std::string("{}"), whole.substr(0, whole.size() / 2),
                                  std::string(R"({"notices":2})")}) {
    std::ofstream(NoticeFileOf(folder_)) << text;
    const NoticeState read = ReadNoticeFile(NoticeFileOf(folder_), trouble_);
    EXPECT_TRUE(read.memory.alarms.empty());
    EXPECT_TRUE(trouble_.starts_with(NoticeFileOf(folder_).string() +
                                     ": cannot be used, what was sent may be sent again: "))
        << trouble_;
  }
}

TEST_F(NoticeFile, IsOneWatchsAlone) {
  const daq::FileDescriptor first = HoldNotices(folder_);
  try {
    HoldNotices(folder_);
    FAIL() << "two hold it";
  } catch (const BenchError& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kWrongInput);
    EXPECT_EQ(error.what(), folder_.root.string() +
                                ": error: another strainwave watch sends its notices already (expected one "
                                "watch a campaign: end that one, or leave it at that)");
  }
}

}  // namespace
}  // namespace strainwave::bench::notice_file_test
