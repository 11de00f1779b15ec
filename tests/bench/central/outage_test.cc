// SPDX-License-Identifier: Apache-2.0
// The server is killed, away, or has no room: nothing is lost, nothing comes twice.
#include <gtest/gtest.h>

#include <sys/mount.h>

#include <atomic>
#include <fstream>
#include <mutex>
#include <thread>

#include "tests/bench/central/lab.h"
#include "tests/bench/central/silent_server.h"

namespace strainwave::bench::outage_test {
namespace {

/// Forwards for ever, beside the test.
class FollowingForward {
 public:
  explicit FollowingForward(ForwardOrder order)
      : order_(std::move(order)), thread_([this] {
          order_.follow = true;
          RunForward(
              order_, [this] { return end_.load(); },
              [this](const std::string& line) {
                const std::lock_guard lock(mutex_);
                told_ += line + '\n';
              });
        }) {}
  FollowingForward(const FollowingForward&) = delete;
  FollowingForward& operator=(const FollowingForward&) = delete;
  ~FollowingForward() {
    end_ = true;
    thread_.join();
  }
  std::string told() const {
    const std::lock_guard lock(mutex_);
    return told_;
  }
  bool HasTold(const std::string& words) const { return told().find(words) != std::string::npos; }

 private:
  ForwardOrder order_;
  mutable std::mutex mutex_;
  std::string told_;
  std::atomic<bool> end_{};
  std::thread thread_;
};

bool HasAll(const Lab& lab, int cycles) {
  try {
    return lab.Value("SELECT count(*) FROM strainwave.cycles WHERE outcome = 'complete'") ==
               std::to_string(cycles) &&
           lab.Value("SELECT bool_and(caught_up) FROM strainwave.campaigns") == "t";
  } catch (const ServerError&) {
    return false;
  }
}

TEST(Outage, ServerKilledAmidABatchHasAllRowsOnce) {
  if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
  Lab lab;
  WrittenCampaign campaign(lab.scratch / "campaign");
  campaign.AddCycles(12);
  auto order = lab.Order(campaign.folder());
  order.settings.cycles_per_batch = 5;
  auto admin = std::make_unique<Server>(lab.postgres.Conninfo("admin"));
  // The first batch stops between two of its tables, as long as this lasts.
  admin->Execute("BEGIN; LOCK TABLE strainwave.result_rows IN SHARE MODE");
  const FollowingForward forward(order);
  Until([&] {
    return Server(lab.postgres.Conninfo("admin"))
               .Run(
                   "SELECT 1 FROM pg_locks WHERE NOT granted AND relation = "
                   "'strainwave.result_rows'::regclass")
               .count() > 0;
  });
  lab.postgres.Kill();
  admin.reset();
  lab.postgres.Start();
  // Again and again, wherever it is.
  for (int kills = 0; kills < 3; ++kills) {
    campaign.AddCycles(10);
    Until([&] { return lab.Value("SELECT count(*) FROM strainwave.cycles") != "0"; });
    lab.postgres.Kill();
    lab.postgres.Start();
  }
  Until([&] { return HasAll(lab, 42); });
  EXPECT_TRUE(forward.HasTold("stays in the campaign's folder, and it is tried again")) << forward.told();
  EXPECT_TRUE(forward.HasTold("the server is there again")) << forward.told();
  EXPECT_EQ(RowsOf(lab.Fetched("fetched")), RowsOf(campaign.folder()));
}

TEST(Outage, WhatARunAddsMeanwhileComesWhenTheServerIsBack) {
  if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
  Lab lab;
  WrittenCampaign campaign(lab.scratch / "campaign");
  campaign.AddCycles(1);
  const FollowingForward forward(lab.Order(campaign.folder()));
  Until([&] { return HasAll(lab, 1); });
  lab.postgres.Stop();
  campaign.AddCycles(30);
  campaign.RaiseAlarm("2026-12-01T10:00:00.000Z");
  Until([&] { return forward.HasTold("tried again"); });
  lab.postgres.Start();
  Until([&] { return HasAll(lab, 31); });
  EXPECT_EQ(RowsOf(lab.Fetched("fetched")), RowsOf(campaign.folder()));
}

TEST(Outage, BenchesThatComeFirstInAMonthAtOnceAllGetIn) {
  if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
  Lab lab;
  lab.AddBench("hall-4");
  WrittenCampaign campaign(lab.scratch / "campaign");
  Server first(lab.postgres.Conninfo("bench_hall-3"));
  first.Execute("BEGIN; SELECT strainwave.register_campaign('a', 'b', 'c', 'd', 'e')");
  const FollowingForward second(lab.Order(campaign.folder(), "hall-4"));
  Until([&] {
    return lab.Value("SELECT count(*) FROM pg_locks WHERE NOT granted AND locktype = 'advisory'") == "1";
  });
  first.Execute("COMMIT");
  Until([&] { return lab.Value("SELECT count(*) FROM strainwave.bench_states") == "1"; });
}

TEST(Outage, WithoutFollowItEndsWhenPatienceDoes) {
  if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
  Lab lab;
  WrittenCampaign campaign(lab.scratch / "campaign");
  lab.postgres.Stop();
  auto order = lab.Order(campaign.folder());
  order.patience_s = 0.2;
  const std::string refusal = RefusalOf([&] { lab.Forward(order); });
  EXPECT_EQ(refusal.substr(0, 3), "3: ") << refusal;
  EXPECT_NE(refusal.find("(expected a PostgreSQL server that answers there)"), std::string::npos) << refusal;
}

// One attempt lasts longer than patience does: there is no third one.
TEST(Outage, AServerThatSaysNothingIsAwayWithinPatience) {
  const ScratchFolder scratch;
  WrittenCampaign campaign(scratch / "campaign");
  SilentServer silent;
  auto order = OrderOf(campaign.folder(), silent.Conninfo());
  order.patience_s = 0.05;
  order.first_wait_s = 0.001;
  order.server.to_connect = std::chrono::milliseconds(100);
  EXPECT_EQ(RefusalOf([&] {
              RunForward(
                  order, [] { return false; }, [](const std::string&) {});
            }),
            "3: the server has said nothing for 0.1 s (expected a PostgreSQL server that answers)");
  EXPECT_LE(silent.connections(), 2);
}

TEST(Outage, AskedToEndBeforeAllIsBroughtItIsInterrupted) {
  const ScratchFolder scratch;
  WrittenCampaign campaign(scratch / "campaign");
  auto order = OrderOf(campaign.folder(), "host=" + (scratch / "nobody").string());
  order.patience_s = 1e9;
  bool end = false;
  EXPECT_EQ(RefusalOf([&] {
              RunForward(
                  order, [&] { return end; }, [&](const std::string&) { end = true; });
            }),
            "130: stopped on request; what is not forwarded stays in the campaign's folder");
}

TEST(Outage, AServiceThatNobodyKnowsIsNotWaitedFor) {
  const ScratchFolder scratch;
  WrittenCampaign campaign(scratch / "campaign");
  auto order = OrderOf(campaign.folder(), "service=nope");
  order.patience_s = 1e9;
  EXPECT_EQ(
      RefusalOf([&] {
        RunForward(
            order, [] { return false; }, [](const std::string&) {});
      }),
      "2: definition of service \"nope\" not found (expected a service of ~/.pg_service.conf, or options "
      "that libpq knows)");
  order.conninfo = "host=/tmp sslmode=x";
  EXPECT_EQ(
      RefusalOf([&] {
        RunForward(
            order, [] { return false; }, [](const std::string&) {});
      }),
      "2: invalid sslmode value: \"x\" (expected a service of ~/.pg_service.conf, or options that libpq "
      "knows)");
  order.conninfo = "host=/tmp port=99999999";
  EXPECT_EQ(RefusalOf([&] {
              RunForward(
                  order, [] { return false; }, [](const std::string&) {});
            }).substr(0, 3),
            "2: ");
}

TEST(Outage, FullDiskOfTheServerIsWaitedFor) {
  if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
  const ScratchFolder disk;
  if (::mount("tmpfs", disk.path().c_str(), "tmpfs", 0, "size=80m,mode=0755") != 0)
    GTEST_SKIP() << "skipped, because this machine lets no test mount a file system";
  struct Unmount {
    const ScratchFolder& folder;
    ~Unmount() { ::umount2(folder.path().c_str(), MNT_DETACH); }
  } const unmount{disk};
  Lab lab(std::make_shared<PostgresServer>(disk / "data"));
  WrittenCampaign campaign(lab.scratch / "campaign");
  campaign.AddCycles(100);
  for (int i = 0; i < 60; ++i) {
    // Random enough for no compression.
    std::string text;
    while (text.size() < 12'000) text += Sha256(fmt::format("{} {}", i, text.size()));
    campaign.journal().AddOperatorNote({"2026-12-01T10:00:00.000Z", "A. Meier", text});
  }
  {
    std::ofstream filler(disk / "filler", std::ios::binary);
    const std::string block(64 * 1024, 'x');
    while (filler.write(block.data(), static_cast<std::streamsize>(block.size())).flush()) {
    }
  }
  const FollowingForward forward(lab.Order(campaign.folder()));
  Until([&] { return forward.HasTold("tried again"); });
  EXPECT_FALSE(HasAll(lab, 100));
  std::filesystem::remove(disk / "filler");
  // Where it had no room for its log, it is gone until somebody starts it.
  lab.postgres.Start();
  Until([&] { return HasAll(lab, 100); });
  EXPECT_EQ(RowsOf(lab.Fetched("fetched")), RowsOf(campaign.folder()));
}

}  // namespace
}  // namespace strainwave::bench::outage_test
