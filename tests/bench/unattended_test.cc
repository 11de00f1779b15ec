// SPDX-License-Identifier: Apache-2.0
// Whether a run may begin with nobody at its terminal.
#include "bench/campaign/unattended.h"

#include <unistd.h>

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "bench/campaign/run_begun.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench::unattended_test {
namespace {

constexpr Moment kNow{1'000'000'000, 500'000, 7};

class Unattended : public testing::Test {
 protected:
  ~Unattended() override { std::filesystem::remove_all(folder_.root); }

  /// A run that a person has begun and that was cut.
  void BeginRun() {
    journal_.SetProperty(kRunBegun, TextOf({0, 0.0, 1}));
    NoteRunBegins(journal_, 0);
  }
  std::string Asked(int allowed, const Moment& now = kNow) {
    try {
      const ResumeOrder start = DemandUnattendedStart(folder_, journal_, {.unattended = allowed}, now);
      return start.by.empty() ? "restart " + std::to_string(start.restart)
                              : "by " + start.by + (start.accept_pause ? ", after any pause" : "");
    } catch (const BenchError& error) {
      const std::string words = error.what();
      const std::size_t begins = words.find("without a person: ") + 18;
      return words.substr(begins, words.find(" (expected one at the bench") - begins);
    }
  }
  void AddEvent(const std::string& severity, const std::string& code, const std::string& text) {
    journal_.AddEvent({1.0, "2026-01-01T00:00:00Z", 1, "", severity, code, text});
  }

  CampaignFolder folder_ = [] {
    const CampaignFolder folder{std::filesystem::temp_directory_path() /
                                ("strainwave_unattended_test_" + std::to_string(::getpid()))};
    std::filesystem::remove_all(folder.root);
    std::filesystem::create_directories(folder.root);
    return folder;
  }();
  Journal journal_ = Journal::Create(folder_.Journal());
};

TEST_F(Unattended, GoesOnAfterACutAsOftenInARowAsTheScheduleSays) {
  BeginRun();
  EXPECT_EQ(Asked(2), "restart 1");
  EXPECT_EQ(Asked(2), "restart 1") << "a try that did not come to a run counts for nothing";
  NoteRunBegins(journal_, 1);
  EXPECT_EQ(Asked(2), "restart 2");
  NoteRunBegins(journal_, 2);
  EXPECT_EQ(UnattendedRestarts(journal_), 2);
  EXPECT_EQ(Asked(2), "it has done so 2 times since a person began it, as often as resume.unattended allows");
  NoteRunBegins(journal_, 0);
  EXPECT_EQ(Asked(2), "restart 1");
}

TEST_F(Unattended, DoesNotGoOnWhereTheScheduleDoesNotSaySo) {
  BeginRun();
  EXPECT_EQ(Asked(0), "resume.unattended of its schedule is 0");
}

TEST_F(Unattended, DoesNotBegin) { EXPECT_EQ(Asked(2), "it has not begun yet"); }

TEST_F(Unattended, DoesNotGoOnAfterAnyEnd) {
  BeginRun();
  NoteRunEnded(journal_, "quick stop");
  EXPECT_EQ(Asked(2), "its last run was not cut, but has ended (quick stop)");
}

TEST_F(Unattended, DoesNotGoOnAfterAFaultWhoseRunWasCutBeforeItsEnd) {
  BeginRun();
  AddEvent("alarm", "torque_limit", "output torque 61 Nm is above 60 Nm");
  EXPECT_EQ(Asked(2), "its last run has ended with an alarm (output torque 61 Nm is above 60 Nm)");
}

TEST_F(Unattended, KeepsAlsoWordsThatAreNoUtf8) {
  BeginRun();
  NoteRunEnded(journal_, "cannot write \xff");
  EXPECT_EQ(Asked(2), "its last run was not cut, but has ended (cannot write \xEF\xBF\xBD)");
}

TEST_F(Unattended, BeginsWhatAPersonHasOrderedAWhileAgo) {
  BeginRun();
  NoteRunEnded(journal_, "quick stop");
  AddEvent("alarm", "torque_limit", "output torque 61 Nm is above 60 Nm");
  KeepRunOrder(journal_, {kNow, "A. Meier", true});
  const Moment later{kNow.utc_ms + 600'000, kNow.since_boot_ms + 600'000, kNow.boot};
  EXPECT_EQ(Asked(0, later), "by A. Meier, after any pause");
  const Moment too_late{later.utc_ms + 1, later.since_boot_ms + 1, later.boot};
  EXPECT_EQ(Asked(0, too_late), "what A. Meier has ordered is too old");
  const Moment clock_set_back{kNow.utc_ms - 86'400'000, kNow.since_boot_ms + 600'001, kNow.boot};
  EXPECT_EQ(Asked(0, clock_set_back), "what A. Meier has ordered is too old");
  const Moment rebooted{kNow.utc_ms + 60'000, 30'000, kNow.boot + 1};
  EXPECT_EQ(Asked(0, rebooted), "what A. Meier has ordered is too old");
}

TEST_F(Unattended, UsesAnOrderUp) {
  KeepRunOrder(journal_, {kNow, "A. Meier", false});
  EXPECT_EQ(Asked(0), "by A. Meier");
  BeginRun();
  NoteRunEnded(journal_, "quick stop");
  EXPECT_EQ(Asked(0), "resume.unattended of its schedule is 0");
}

// What an order that counts no more says must not stand in the way of what the schedule allows.
TEST_F(Unattended, GoesOnAfterACutAlsoWithAnOrderThatIsTooOld) {
  BeginRun();
  KeepRunOrder(journal_, {{0, 0, 6}, "A. Meier", false});
  EXPECT_EQ(Asked(1), "restart 1");
}

}  // namespace
}  // namespace strainwave::bench::unattended_test
