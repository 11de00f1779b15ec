// SPDX-License-Identifier: Apache-2.0
// A journal whose file is damaged, read where nothing can be written, or left behind by a killed program.
#include <linux/capability.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <zlib.h>

#include "bench/campaign/journal.h"
#include "bench/campaign/page_checksums.h"

namespace strainwave::bench::journal_pages_test {
namespace {

namespace fs = std::filesystem;

class JournalPages : public testing::Test {
 protected:
  JournalPages() {
    fs::create_directories(folder_);
    Journal journal = Journal::Create(file_);
    Fill(journal);
  }
  ~JournalPages() override {
    fs::permissions(folder_, fs::perms::owner_all);
    fs::remove_all(folder_);
  }

  static void Fill(Journal& journal) {
    for (int cycle = 1; cycle <= 40; ++cycle) {
      journal.BeginCycle(cycle, cycle);
      journal.AddResults(cycle, 0, {{"k2_Nm_per_rad", 20000.0 + cycle, 10.0, std::string(300, 'f')}});
      journal.EndCycle(cycle, cycle + 0.5, "complete", "digest");
    }
  }
  std::string Bytes() const {
    std::ifstream stream(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void Write(const std::string& bytes) const { std::ofstream(file_, std::ios::binary) << bytes; }
  std::string WordsOfOpening() const {
    try {
      Journal::Open(file_, Database::Mode::kReadOnly);
    } catch (const DatabaseError& error) {
      return error.what();
    }
    return "";
  }
  // What another program with SQLite does to the file.
  void ExecuteElsewhere(const char* sql) const {
    sqlite3* other = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &other), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(other, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(other);
    sqlite3_close(other);
  }
  // Rows of a process that then is gone without closing the file.
  void LeaveALog() const {
    const pid_t process = ::fork();
    if (process == 0) {
      Journal journal = Journal::Open(file_, Database::Mode::kReadWrite);
      journal.AddEvent({1.0, "utc", 1, "phase", "info", "code", "from the log"});
      ::_exit(0);
    }
    ::waitpid(process, nullptr, 0);
    ASSERT_GT(fs::file_size(file_.string() + "-wal"), 0u);
  }

  fs::path folder_ = fs::temp_directory_path() / ("strainwave_journal_pages_" + std::to_string(::getpid()));
  fs::path file_ = folder_ / "campaign.db";
};

// The layout that page_checksums.h describes, by zlib alone.
TEST_F(JournalPages, EndInTheChecksumThatIsDescribed) {
  const std::string bytes = Bytes();
  ASSERT_GT(bytes.size(), 3 * kPage_bytes);
  for (std::uint32_t number = 1; number <= bytes.size() / kPage_bytes; ++number) {
    const auto* page = reinterpret_cast<const unsigned char*>(bytes.data()) + (number - 1) * kPage_bytes;
    const unsigned char place[4] = {static_cast<unsigned char>(number), 0, 0, 0};
    const auto crc = static_cast<std::uint32_t>(crc32_z(crc32_z(0, place, 4), page, kPage_bytes - 8));
    std::array<std::uint32_t, 2> stored{};
    std::memcpy(stored.data(), page + kPage_bytes - 8, 8);
    EXPECT_EQ(stored[0], crc) << number;
    EXPECT_EQ(stored[1], ~crc) << number;
  }
}

TEST_F(JournalPages, AreRefusedWithAnyBitFlipped) {
  const std::string whole = Bytes();
  std::size_t found = 0, flips = 0;
  // A stride without a common factor with the page meets all places of pages, the header's among them.
  for (std::size_t at = 0; at < whole.size(); at += at < 128 ? 1 : 97) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
    Write(damaged);
    ++flips;
    if (!WordsOfOpening().empty()) ++found;
  }
  EXPECT_EQ(found, flips);
  std::string damaged = whole;
  damaged[2 * kPage_bytes + 100] = static_cast<char>(damaged[2 * kPage_bytes + 100] ^ 4);
  Write(damaged);
  EXPECT_EQ(WordsOfOpening(), file_.string() + ": error: page 3 of " +
                                  std::to_string(whole.size() / kPage_bytes) +
                                  " does not match its checksum: a bit has changed, or another program has "
                                  "written to it (expected the "
                                  "journal as it was written; bring it back from a copy)");
  Write(whole);
  EXPECT_EQ(WordsOfOpening(), "");
}

TEST_F(JournalPages, AreRefusedWhenTheLastOnesAreMissing) {
  const std::string whole = Bytes();
  Write(whole.substr(0, whole.size() - kPage_bytes));
  EXPECT_EQ(WordsOfOpening(),
            file_.string() + ": error: it is cut, " + std::to_string(whole.size() / kPage_bytes - 1) +
                " pages are left (expected the journal as it was written; bring it back from a copy)");
}

TEST_F(JournalPages, AreReadByOthersAndRefusedOnceOthersHaveChangedThem) {
  ExecuteElsewhere("SELECT SUM(value) FROM results; PRAGMA integrity_check");
  EXPECT_EQ(WordsOfOpening(), "");
  ExecuteElsewhere("UPDATE results SET value = 0 WHERE cycle = 3");
  EXPECT_NE(WordsOfOpening().find("another program has written to it"), std::string::npos)
      << WordsOfOpening();
}

TEST_F(JournalPages, AreTakenFromALogThatAnotherProgramHasWrittenBack) {
  LeaveALog();
  ExecuteElsewhere("SELECT COUNT(*) FROM events");  // the last to close it copies the log into the file
  EXPECT_EQ(WordsOfOpening(), "");
  const Journal journal = Journal::Open(file_, Database::Mode::kReadOnly);
  EXPECT_EQ(journal.Events(1).at(0).text, "from the log");
  EXPECT_NE(journal.Unchecked().find("were written by another program, without checksums"),
            std::string::npos);
}

TEST_F(JournalPages, AreReadFromALogWhereNothingCanBeWritten) {
  LeaveALog();
  for (const bool with_index : {true, false}) {
    if (!with_index) fs::remove(file_.string() + "-shm");
    const pid_t process = ::fork();
    if (process == 0) {
      // Root may write anywhere; without its capabilities it is held to the permissions of what it owns.
      __user_cap_header_struct header{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
      const __user_cap_data_struct none[_LINUX_CAPABILITY_U32S_3]{};
      if (::syscall(SYS_capset, &header, none) != 0) ::_exit(3);
      fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
      try {
        const Journal journal = Journal::Open(file_, Database::Mode::kReadOnly);
        ::_exit(journal.Events(1).at(0).text == "from the log" && journal.LastCompleteCycle() == 40 ? 0 : 1);
      } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        ::_exit(2);
      }
    }
    int status = 0;
    ::waitpid(process, &status, 0);
    fs::permissions(folder_, fs::perms::owner_all);
    EXPECT_EQ(status, 0) << (with_index ? "with" : "without") << " campaign.db-shm";
  }
}

TEST_F(JournalPages, OfEarlierVersionsAreReadAndSaidToBeUnchecked) {
  fs::remove(file_);
  {
    // As version 1 made it: no room for checksums, no digests.
    const Database database(file_, Database::Mode::kCreate);
    for (const char* sql :
         {"PRAGMA application_id=1398227286", "PRAGMA user_version=1",
          "CREATE TABLE campaign(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID",
          "CREATE TABLE cycles(cycle INTEGER PRIMARY KEY, outcome TEXT NOT NULL, started_s REAL NOT NULL, "
          "ended_s REAL)",
          "CREATE TABLE phases(id INTEGER PRIMARY KEY)",
          "CREATE TABLE events(id INTEGER PRIMARY KEY, time_s REAL NOT NULL, utc TEXT NOT NULL, cycle "
          "INTEGER "
          "NOT NULL, phase TEXT NOT NULL, severity TEXT NOT NULL, code TEXT NOT NULL, text TEXT NOT NULL)",
          "CREATE TABLE results(cycle INTEGER NOT NULL, repeat INTEGER NOT NULL, quantity TEXT NOT NULL, "
          "value REAL, "
          "standard_error REAL, flag TEXT NOT NULL, PRIMARY KEY(cycle, repeat, quantity)) WITHOUT ROWID"}) {
      database.Execute(sql);
    }
  }
  Journal journal = Journal::Open(file_, Database::Mode::kReadWrite);
  Fill(journal);
  EXPECT_EQ(journal.LastCompleteCycle(), 40);
  EXPECT_EQ(journal.RecordsSha256(40), "");
  EXPECT_EQ(journal.Unchecked(),
            "of an earlier version, without checksums: a bit that changes in it is not noticed");
}

}  // namespace
}  // namespace strainwave::bench::journal_pages_test
