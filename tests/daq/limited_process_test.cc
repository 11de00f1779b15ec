// SPDX-License-Identifier: Apache-2.0
#include "daq/limited_process.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>
#include <vector>

#include "daq/record_pipe.h"
#include "tests/daq/sample_records.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::limited_process_test {
namespace {

using std::chrono::seconds;

constexpr ProcessLimits kLimits{
    .memory_bytes = std::size_t{256} << 20, .processor = seconds(1), .silence = seconds(60)};

std::string EndOf(const std::function<void(int)>& work, const ProcessLimits& limits = kLimits) {
  LimitedProcess process(limits, work);
  std::byte bytes[16];
  while (process.Read(bytes) > 0) {
  }
  return process.End();
}

void WaitForEver(int) {
  while (true) ::pause();
}

TEST(LimitedProcess, BringsBackItsBytesAndEndsWell) {
  LimitedProcess process(kLimits, [](int pipe) {
    const std::vector<std::byte> much(3'000'000, std::byte{7});
    WriteToPipe(pipe, much);
  });
  std::vector<std::byte> bytes(65536);
  std::size_t all = 0;
  for (std::size_t got = 0; (got = process.Read(bytes)) > 0;) {
    EXPECT_EQ(bytes[got - 1], std::byte{7});
    all += got;
  }
  EXPECT_EQ(all, 3'000'000U);
  EXPECT_EQ(process.End(), "");
}

TEST(LimitedProcess, SaysHowItEnded) {
  EXPECT_EQ(EndOf([](int) { std::raise(SIGSEGV); }), "crashed (Segmentation fault)");
  EXPECT_EQ(EndOf([](int) { std::abort(); }), "crashed (Aborted)");
  EXPECT_EQ(EndOf([](int) { throw std::runtime_error("any"); }), "failed");
  EXPECT_EQ(EndOf([](int) {
              const volatile bool goes_on = true;
              while (goes_on) {
              }
            }),
            "took more than 1 s");
  EXPECT_EQ(EndOf(WaitForEver, {.memory_bytes = 1 << 20, .processor = seconds(1), .silence = seconds(0)}),
            "said nothing for 0 s");
}

TEST(LimitedProcess, SaysThatItNeededMoreMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "skipped, because a sanitizer reserves its own address space";
#endif
  EXPECT_EQ(EndOf([](int) { const std::vector<char> much(std::size_t{1} << 30, 'x'); }),
            "needed more than 256 MiB of memory");
}

TEST(LimitedProcess, EndsWithItsOwner) {
  pid_t child{};
  {
    LimitedProcess process(kLimits, [](int pipe) {
      const pid_t own = ::getpid();
      WriteToPipe(pipe, std::as_bytes(std::span(&own, 1)));
      WaitForEver(pipe);
    });
    ASSERT_EQ(process.Read(std::as_writable_bytes(std::span(&child, 1))), sizeof child);
  }
  EXPECT_EQ(::kill(child, 0), -1);
}

TEST(ReadInOwnProcess, GivesWhatWasRead) {
  const std::vector<Record> records{SampleSweep(), SampleLoop(), SampleVibration()};
  const std::vector<Record> read = ReadInOwnProcess("a.h5", kLimits, [&] { return records; });
  ASSERT_EQ(read.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(SameRecord(read[i], records[i])) << i;
}

TEST(ReadInOwnProcess, GivesEveryFinding) {
  const RecordError error({{"a.h5", "one", "good"}, {"a.h5", "two", "better"}});
  EXPECT_EQ(MessageOf<RecordError>(
                [&] { ReadInOwnProcess("a.h5", kLimits, [&]() -> std::vector<Record> { throw error; }); }),
            "a.h5: error: one (expected good)\na.h5: error: two (expected better)");
}

TEST(ReadInOwnProcess, TurnsACrashIntoWords) {
  EXPECT_EQ(
      MessageOf<RecordError>([&] {
        ReadInOwnProcess("a.h5", kLimits, []() -> std::vector<Record> {
          std::raise(SIGSEGV);
          return {};
        });
      }),
      "a.h5: error: the HDF5 library cannot read the file: it crashed (Segmentation fault) (expected the "
      "file as it was written)");
}

}  // namespace
}  // namespace strainwave::daq::limited_process_test
