// SPDX-License-Identifier: Apache-2.0
#include "bench/page/another_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::page_process_test {
namespace {

using std::chrono::hours;
using std::chrono::seconds;

// A shell that does what it is told, as a child of this process.
class Shell {
 public:
  explicit Shell(const std::string& command) : process_(::fork()) {
    if (process_ != 0) return;
    ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    std::_Exit(127);
  }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;
  ~Shell() {
    if (::waitpid(process_, nullptr, WNOHANG) != 0) return;  // it has ended
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }

  pid_t process() const { return process_; }

 private:
  pid_t process_;
};

class AnotherProcess : public testing::Test {
 protected:
  bool Says(const std::string& word) {
    ++looks_;
    return LastLineOf(file_) == word;
  }

  const daq::ScratchFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "said";
  int looks_{};
};

TEST_F(AnotherProcess, IsWaitedForByWhatItWrites) {
  const Shell shell("for i in 1 2 3; do echo $i >> '" + file_.string() +
                    "'; sleep 0.3; done; exec sleep 1000");
  EXPECT_EQ(Await(shell.process(), file_, hours(1), [&] { return Says("3"); }), Awaited::kDone);
  EXPECT_LT(looks_, 20) << "it sleeps in between";
}

TEST_F(AnotherProcess, IsSeenToHaveDoneItBefore) {
  std::ofstream(file_) << "done\n";
  const Shell shell("exec sleep 1000");
  EXPECT_EQ(Await(shell.process(), file_, hours(1), [&] { return Says("done"); }), Awaited::kDone);
}

TEST_F(AnotherProcess, ThatEndsIsWaitedForNoLonger) {
  const Shell in_vain("exit 1");
  EXPECT_EQ(Await(in_vain.process(), file_, hours(1), [&] { return Says("done"); }), Awaited::kEnded);
  const Shell in_time("echo done > '" + file_.string() + "'");
  EXPECT_EQ(Await(in_time.process(), file_, hours(1), [&] { return Says("done"); }), Awaited::kDone);
}

TEST_F(AnotherProcess, ThatDoesNothingIsNotWaitedForForEver) {
  const Shell shell("touch '" + (folder_.path() / "another file").string() + "'; exec sleep 1000");
  EXPECT_EQ(Await(shell.process(), file_, seconds(1), [&] { return Says("done"); }), Awaited::kNothing);
  EXPECT_EQ(looks_, 1) << "other files are none of its business";
}

// A row may be written before it counts.
TEST_F(AnotherProcess, IsLookedAtOnceMoreAfterAChange) {
  const Shell shell("echo done > '" + file_.string() + "'; exec sleep 1000");
  const auto counts_later = [&] { return Says("done") && looks_ > 2; };
  EXPECT_EQ(Await(shell.process(), file_, hours(1), counts_later), Awaited::kDone);
}

}  // namespace
}  // namespace strainwave::bench::page_process_test
