// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/outbox.h"

#include <sys/resource.h>

#include <csignal>
#include <memory>

#include <gtest/gtest.h>

#include "bench/errors/bench_error.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::monitor_outbox_test {
namespace {

using protocols::SparkplugMetric;
using protocols::SparkplugQuality;

std::vector<SparkplugMetric> Entry(std::int64_t number) { return {{.name = "Window", .value = number}}; }

std::int64_t NumberOf(const std::vector<SparkplugMetric>* entry) {
  return entry == nullptr ? -1 : std::get<std::int64_t>(entry->front().value);
}

TEST(Outbox, LetsGoOnlyOfWhatWasAcknowledged) {
  Outbox outbox({});
  for (const std::int64_t number : {1, 2, 3}) outbox.Push(Entry(number), true);
  EXPECT_EQ(NumberOf(outbox.Next()), 1);
  outbox.Sent(100);
  EXPECT_EQ(NumberOf(outbox.Next()), 2);
  outbox.Sent(101);
  outbox.Acknowledge(101);
  outbox.Acknowledge(999);
  EXPECT_EQ(outbox.size(), 2U);
  outbox.ConnectionLost();
  EXPECT_EQ(NumberOf(outbox.Next()), 1) << "what was under way waits again, in its place";
  outbox.Acknowledge(100);
  EXPECT_EQ(outbox.size(), 2U) << "a number of the connection before means nothing";
}

TEST(Outbox, WhatWaitedForAConnectionIsHistorical) {
  Outbox outbox({});
  outbox.Push(Entry(1), true);
  EXPECT_FALSE(outbox.Next()->front().is_historical);
  outbox.Sent(7);
  outbox.ConnectionLost();
  EXPECT_TRUE(outbox.Next()->front().is_historical);
  outbox.Sent(8);
  outbox.Push(Entry(2), false);
  EXPECT_TRUE(outbox.Next()->front().is_historical);
}

TEST(Outbox, DropsTheOldestAndCountsThem) {
  Outbox outbox({.windows = 3, .bytes = 1 << 20});
  for (std::int64_t number = 1; number <= 5; ++number) outbox.Push(Entry(number), true);
  EXPECT_EQ(outbox.size(), 3U);
  EXPECT_EQ(outbox.dropped(), 2U);
  EXPECT_EQ(NumberOf(outbox.Next()), 3);
}

TEST(Outbox, HasABoundInBytesThatOneEntryMayExceed) {
  Outbox one({});
  one.Push(Entry(1), true);
  const std::size_t bytes = one.bytes();
  Outbox outbox({.windows = 100, .bytes = 4 * bytes + bytes / 2});
  for (std::int64_t number = 1; number <= 9; ++number) outbox.Push(Entry(number), true);
  EXPECT_EQ(outbox.size(), 4U);
  EXPECT_EQ(outbox.bytes(), 4 * bytes);
  outbox.Push({{.name = std::string(100 * bytes, 'x'), .value = 0.0}}, true);
  EXPECT_EQ(outbox.size(), 0U);
  EXPECT_EQ(outbox.bytes(), 0U);
  EXPECT_EQ(outbox.dropped(), 10U);
}

TEST(Outbox, AnEntryThatWentWhileUnderWayIsLostOnlyIfItDidNotArrive) {
  for (const bool arrives : {true, false}) {
    Outbox outbox({.windows = 1, .bytes = 1 << 20});
    outbox.Push(Entry(1), true);
    outbox.Next();
    outbox.Sent(1);
    outbox.Push(Entry(2), true);
    EXPECT_EQ(outbox.under_way(), 0U);
    EXPECT_EQ(outbox.dropped(), 0U);
    if (arrives) outbox.Acknowledge(1);
    outbox.ConnectionLost();
    EXPECT_EQ(outbox.dropped(), arrives ? 0U : 1U);
    EXPECT_EQ(outbox.size(), 1U);
  }
}

class OutboxOnDisk : public testing::Test {
 protected:
  Outbox Open(OutboxBounds bounds = {}) { return Outbox(bounds, std::make_unique<OutboxStore>(file_)); }
  static std::string NumbersIn(const Outbox& outbox) {
    std::string text;
    for (std::size_t i = 0; outbox.At(i) != nullptr; ++i)
      text += std::to_string(NumberOf(outbox.At(i))) + " ";
    return text;
  }

  daq::ScratchFolder folder_;
  std::filesystem::path file_{folder_ / "outbox.db"};
};

TEST_F(OutboxOnDisk, WhatWaitsOutlivesTheMonitorInItsOrder) {
  {
    Outbox outbox = Open();
    for (const std::int64_t number : {1, 2, 3, 4, 5}) outbox.Push(Entry(number), true);
    for (const int ticket : {1, 2, 3}) {
      outbox.Next();
      outbox.Sent(ticket);
    }
    outbox.Acknowledge(std::vector<int>{1, 3});
    outbox.KeepNextBirth(17);
  }
  {
    Outbox outbox = Open();
    EXPECT_EQ(NumbersIn(outbox), "2 4 5 ");
    EXPECT_TRUE(outbox.Next()->front().is_historical);
    outbox.Push(Entry(6), true);
  }
  EXPECT_EQ(NumbersIn(Open()), "2 4 5 6 ");
  const OutboxStore store(file_);
  EXPECT_EQ(store.last_window(), 6);
  EXPECT_EQ(store.next_birth(), 17);
}

TEST_F(OutboxOnDisk, MetricsComeBackAsTheyWere) {
  const std::vector<SparkplugMetric> metrics{
      {.name = "Window", .value = std::int64_t{-3}, .time_ms = 1'700'000'000'123},
      {.name = "a/Value", .value = 0.1, .time_ms = 5, .is_null = true, .quality = SparkplugQuality::kStale},
      {.name = "Quality", .value = std::string("a\0b", 3), .time_ms = 6},
      {.name = "Outside training", .value = true, .time_ms = 7, .quality = SparkplugQuality::kBad}};
  {
    Outbox outbox = Open();
    outbox.Push(metrics, true);
  }
  const Outbox outbox = Open();
  const auto& back = *outbox.At(0);
  ASSERT_EQ(back.size(), metrics.size());
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    EXPECT_EQ(back[i].name, metrics[i].name);
    EXPECT_EQ(back[i].time_ms, metrics[i].time_ms);
    EXPECT_EQ(back[i].is_null, metrics[i].is_null);
    EXPECT_EQ(back[i].quality, metrics[i].quality);
    if (metrics[i].is_null) continue;
    EXPECT_EQ(back[i].value, metrics[i].value);
  }
}

TEST_F(OutboxOnDisk, TheBoundHoldsOnDiskAndDroppedEntriesGoOnBeingCounted) {
  {
    Outbox outbox = Open({.windows = 3, .bytes = 1 << 20});
    for (std::int64_t number = 1; number <= 5; ++number) outbox.Push(Entry(number), true);
  }
  {
    const Outbox outbox = Open({.windows = 2, .bytes = 1 << 20});
    EXPECT_EQ(NumbersIn(outbox), "4 5 ");
    EXPECT_EQ(outbox.dropped(), 3U);
  }
  const OutboxStore store(file_);
  EXPECT_EQ(store.Entries().size(), 2U);
  EXPECT_EQ(store.dropped(), 3U);
}

TEST_F(OutboxOnDisk, ADiskThatRefusesStopsNothingAndIsMadeUpForLater) {
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, SIG_IGN);
  {
    Outbox outbox = Open();
    outbox.Push(Entry(1), true);
    EXPECT_EQ(outbox.trouble(), "");
    const rlimit none{0, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &none);
    outbox.Push(Entry(2), true);
    outbox.Push(Entry(3), true);
    ::setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_TRUE(outbox.trouble().starts_with(file_.string() + ": error: ")) << outbox.trouble();
    EXPECT_EQ(NumbersIn(outbox), "1 2 3 ");
    outbox.Push(Entry(4), true);
    EXPECT_EQ(outbox.trouble(), "");
  }
  EXPECT_EQ(NumbersIn(Open()), "1 2 3 4 ");
}

TEST_F(OutboxOnDisk, IsForOneMonitorAtATimeAndNoOtherFile) {
  {
    Outbox outbox = Open();
    outbox.Push(Entry(1), true);
    EXPECT_EQ(daq::MessageOf<BenchError>([&] { OutboxStore{file_}; }),
              file_.string() + ": error: another monitor has it open (expected an outbox_file of its own)");
  }
  daq::WriteBytes(folder_ / "text", std::string(4096, 'x'));
  EXPECT_EQ(daq::MessageOf<BenchError>([&] { OutboxStore{folder_ / "text"}; }),
            (folder_ / "text").string() +
                ": error: this is no outbox (expected a file that a monitor made, or none)");
  Database(folder_ / "other", Database::Mode::kCreate).Execute("CREATE TABLE a(b)");
  EXPECT_EQ(
      daq::MessageOf<BenchError>([&] { OutboxStore{folder_ / "other"}; }),
      (folder_ / "other").string() +
          ": error: this is a database of something else (expected an outbox of this version, or no file)");
  Database(file_, Database::Mode::kReadWrite).Execute("UPDATE entries SET metrics = x'0aff'");
  EXPECT_EQ(daq::MessageOf<BenchError>([&] { Open(); }),
            file_.string() +
                ": error: entry 1 cannot be read (expected an outbox as a monitor left it; move the file "
                "away to begin a new one)");
}

}  // namespace
}  // namespace strainwave::bench::monitor_outbox_test
