// SPDX-License-Identifier: Apache-2.0
#include "daq/whole_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <functional>

#include "daq/cycle_file.h"
#include "daq/data_file_error.h"
#include "tests/daq/sample_records.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::whole_file_test {
namespace {

std::string WriteError(const std::filesystem::path& path, const std::string& text = "new") {
  return MessageOf<DataFileError>([&] { WriteFileAtomically(path, text); });
}

// What `say` returns in a child process, which may limit or mount what it likes.
std::string InChildProcess(const std::function<std::string()>& say) {
  int ends[2];
  if (::pipe(ends) != 0) return "no pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    const std::string text = say();
    const bool sent = ::write(ends[1], text.data(), text.size()) == static_cast<ssize_t>(text.size());
    ::_exit(sent ? 0 : 1);
  }
  ::close(ends[1]);
  std::string text;
  char buffer[4096];
  for (ssize_t got = 0; (got = ::read(ends[0], buffer, sizeof buffer)) > 0;) {
    text.append(buffer, static_cast<std::size_t>(got));
  }
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  return text;
}

constexpr char kMountNotAllowed[] = "mount not allowed";

// A file system of 64 KiB in memory, seen by this process alone.
bool MountSmallFileSystem(const std::filesystem::path& where, unsigned long flags) {
  if (::unshare(CLONE_NEWNS) != 0) return false;
  ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
  return ::mount("tmpfs", where.c_str(), "tmpfs", flags, "size=65536") == 0;
}

TEST(WriteFileAtomically, ReplacesAFileAndLeavesNoPartial) {
  const ScratchFolder folder;
  WriteFileAtomically(folder / "a.csv", std::string("old and long"));
  WriteFileAtomically(folder / "a.csv", std::string("new"));
  EXPECT_EQ(BytesOf(folder / "a.csv"), "new");
  EXPECT_FALSE(std::filesystem::exists(folder / ".a.csv.partial"));
}

TEST(WriteFileAtomically, LeavesAPartialAloneThatAnotherOneWrites) {
  const ScratchFolder folder;
  const int other = ::open((folder / ".a.csv.partial").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  ASSERT_EQ(::flock(other, LOCK_EX | LOCK_NB), 0);
  ASSERT_EQ(::write(other, "half", 4), 4);
  WriteFileAtomically(folder / "a.csv", std::string("new"));
  EXPECT_EQ(BytesOf(folder / "a.csv"), "new");
  EXPECT_EQ(BytesOf(folder / ".a.csv.partial"), "half");
  EXPECT_FALSE(std::filesystem::exists(folder / ".a.csv.1.partial"));
  // Whose writer is gone is written over.
  ::close(other);
  WriteFileAtomically(folder / "a.csv", std::string("newer"));
  EXPECT_EQ(BytesOf(folder / "a.csv"), "newer");
  EXPECT_FALSE(std::filesystem::exists(folder / ".a.csv.partial"));
}

TEST(WriteFileAtomically, WritesToANameWithoutAFolder) {
  const ScratchFolder folder;
  const std::string left = InChildProcess([&] {
    std::filesystem::current_path(folder.path());
    WriteFileAtomically("here.txt", std::string("text"));
    return BytesOf("here.txt");
  });
  EXPECT_EQ(left, "text");
}

TEST(WriteFileAtomically, NamesTheStepAndThePathThatFailed) {
  const ScratchFolder folder;
  EXPECT_EQ(WriteError(folder / "none/a.csv"),
            "cannot create '" + (folder / "none/.a.csv.partial").string() + "': No such file or directory");
  WriteBytes(folder / "file", "");
  EXPECT_EQ(WriteError(folder / "file/a.csv"),
            "cannot create '" + (folder / "file/.a.csv.partial").string() + "': Not a directory");
  std::filesystem::create_directory(folder / "taken");
  EXPECT_EQ(WriteError(folder / "taken"),
            "cannot rename the finished file to '" + (folder / "taken").string() + "': Is a directory");
  EXPECT_FALSE(std::filesystem::exists(folder / ".taken.partial"));
}

TEST(WriteFileAtomically, KeepsTheOldFileWhenAWriteFailsHalfway) {
  const ScratchFolder folder;
  WriteFileAtomically(folder / "a.csv", std::string("old"));
  const std::string said = InChildProcess([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    return WriteError(folder / "a.csv", std::string(5000, 'x'));
  });
  EXPECT_EQ(said, "cannot write '" + (folder / ".a.csv.partial").string() + "': File too large");
  EXPECT_EQ(BytesOf(folder / "a.csv"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder / ".a.csv.partial"));
}

TEST(WriteFileAtomically, SaysThatTheDiskIsFullAndFreesWhatItTook) {
  const ScratchFolder folder;
  const std::string said = InChildProcess([&]() -> std::string {
    if (!MountSmallFileSystem(folder.path(), 0)) return kMountNotAllowed;
    WriteFileAtomically(folder / "a.csv", std::string("old"));
    const std::string message = WriteError(folder / "a.csv", std::string(200000, 'x'));
    const auto files = std::filesystem::directory_iterator(folder.path());
    return message + "; kept " + BytesOf(folder / "a.csv") + " and " +
           std::to_string(std::distance(begin(files), end(files)) - 1) + " more";
  });
  if (said == kMountNotAllowed)
    GTEST_SKIP() << "skipped, because this user may not mount a small file system";
  EXPECT_EQ(said, "cannot write '" + (folder / ".a.csv.partial").string() +
                      "': No space left on device; kept old and 0 more");
}

TEST(WriteFileAtomically, SaysThatTheFolderIsReadOnly) {
  const ScratchFolder folder;
  const std::string said = InChildProcess([&]() -> std::string {
    if (!MountSmallFileSystem(folder.path(), MS_RDONLY)) return kMountNotAllowed;
    return WriteError(folder / "a.csv");
  });
  if (said == kMountNotAllowed)
    GTEST_SKIP() << "skipped, because this user may not mount a small file system";
  EXPECT_EQ(said, "cannot create '" + (folder / ".a.csv.partial").string() + "': Read-only file system");
}

TEST(WriteRecordsAtomically, SaysThatTheDiskIsFullWithoutHalfAFile) {
  const ScratchFolder folder;
  const std::string said = InChildProcess([&]() -> std::string {
    if (!MountSmallFileSystem(folder.path(), 0)) return kMountNotAllowed;
    Record record = SampleVibration();
    for (Column& column : record.columns) column.values = std::vector<float>(100000, 1.0F);
    const std::vector<NamedRecord> records{{"accel", record}};
    const std::string message =
        MessageOf<DataFileError>([&] { WriteRecordsAtomically(folder / "000001.h5", records); });
    return message + (folder.is_empty() ? "; nothing left" : "; something left");
  });
  if (said == kMountNotAllowed)
    GTEST_SKIP() << "skipped, because this user may not mount a small file system";
  EXPECT_EQ(said, "cannot write '" + (folder / ".000001.h5.partial").string() +
                      "': No space left on device; nothing left");
}

// Killed at any moment of writing over and over, what is there under the name is always whole.
TEST(WriteFileAtomically, IsWholeWhenKilledAtAnyMoment) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "a.txt";
  const auto content = [](int i) {
    return std::string(20000 + static_cast<std::size_t>(i % 7), 'a') + std::to_string(i);
  };
  WriteFileAtomically(path, content(0));
  for (int round = 0; round < 20; ++round) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      for (int i = 0;; ++i) {
        WriteFileAtomically(path, content(i));
        if (i == round && ::write(ends[1], "x", 1) != 1) ::_exit(1);
      }
    }
    char ready{};
    ASSERT_EQ(::read(ends[0], &ready, 1), 1);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    ::close(ends[0]);
    ::close(ends[1]);
    const std::string left = BytesOf(path);
    const std::size_t digits = left.find_first_not_of('a');
    ASSERT_NE(digits, left.npos);
    ASSERT_EQ(left, content(std::stoi(left.substr(digits)))) << round;
  }
}

}  // namespace
}  // namespace strainwave::daq::whole_file_test
