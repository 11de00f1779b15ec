// SPDX-License-Identifier: Apache-2.0
// How much a PostgreSQL server takes of many benches, and how fast the page of all of them is meanwhile.
// usage: central_benchmark [BENCHES [CYCLES_PER_S [SECONDS]]]
// A server of its own; each cycle comes as a bench sends it: a connection with a password, what the server
// has, the rows of one cycle, the state.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/central/campaign_sender.h"
#include "bench/central/fleet_view.h"
#include "bench/utc.h"
#include "tests/bench/central/postgres.h"

namespace strainwave {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kResultsPerCycle = 26;  // of schedules/quick.yaml
constexpr int kPhasesPerCycle = 4;
constexpr int kSenders = 8;
constexpr double kSecondsPerDay = 86'400.0;

double SecondsSince(Clock::time_point begun) {
  return std::chrono::duration<double>(Clock::now() - begun).count();
}

std::string BenchName(int bench) { return fmt::format("bench_{:05d}", bench); }

bench::SentCampaign CampaignOf(int number) {
  return {fmt::format("{:016x}", number), "paper", fmt::format("A{:05d}", number),
          "2026-12-01T10:00:00.000Z"};
}

bench::JournalBatch CycleOf(int cycle) {
  bench::JournalBatch batch;
  nlohmann::json phases = nlohmann::json::array();
  for (int i = 0; i < kPhasesPerCycle; ++i) {
    phases.push_back({kPhasesPerCycle * cycle + i, cycle, i, 0, 1, "transmission_error", "transmission_error",
                      1800.0 * cycle + 99.177 * i, 1800.0 * cycle + 271.667 * i, "complete", 0.0});
  }
  batch.cycles.push_back(
      {cycle, "complete", 1800.0 * cycle, 1800.0 * cycle + 1799.5, std::string(64, 'a'), phases.dump()});
  bench::SentResults results{cycle, 0, {}, {}, {}, {}};
  for (int i = 0; i < kResultsPerCycle; ++i) {
    results.quantities.push_back(fmt::format("quantity_{:02d}_Nm_per_rad", i));
    results.values.push_back(15'000.0 + 1.0 / (cycle + i + 1));
    results.standard_errors.push_back(20.0 / 3.0);
    results.flags.emplace_back();
  }
  batch.results.push_back(std::move(results));
  batch.rows.push_back(
      {"chain", cycle + 1, "",
       nlohmann::json({cycle + 1, "cycle", std::to_string(cycle), std::string(64, 'b')}).dump()});
  batch.is_last = true;
  return batch;
}

void MakeBenches(const PostgresServer& postgres, int benches) {
  bench::Server admin(postgres.Conninfo("admin"));
  // One password for all, and one verifier: to make ten thousand takes minutes, and the server computes as
  // much.
  const std::string verifier = admin.Verifier("bench", "secret");
  std::string statements = "SET synchronous_commit = off; ";
  for (int bench = 0; bench < benches; ++bench) {
    statements += fmt::format(
        "CREATE ROLE {0} LOGIN IN ROLE strainwave_bench PASSWORD '{1}'; INSERT INTO "
        "strainwave.benches(name, role) VALUES ('{0}', '{0}'); ",
        BenchName(bench), verifier);
    if (bench % 500 == 499 || bench + 1 == benches) admin.Execute(std::exchange(statements, ""));
  }
}

struct Load {
  std::atomic<std::int64_t> next{};  // cycle of all benches, one after the other
  std::atomic<std::int64_t> sent{};
  std::atomic<std::int64_t> failed{};  // connections that did not get as far as that
  std::atomic<bool> end{};
};

void Send(const PostgresServer& postgres, int benches, double cycles_per_s, Clock::time_point begun,
          Load& load) {
  while (!load.end) {
    const std::int64_t number = load.next++;
    const auto due = begun + std::chrono::duration<double>(static_cast<double>(number) / cycles_per_s);
    std::this_thread::sleep_until(std::chrono::time_point_cast<Clock::duration>(due));
    const int bench = static_cast<int>(number % benches);
    const int cycle = static_cast<int>(number / benches);
    bench::Server server(postgres.Conninfo(BenchName(bench)));
    bench::CampaignSender sender;
    sender.Begin(server, "machine", CampaignOf(bench), bench::UtcMilliseconds());
    sender.Marks(server);
    sender.Send(server, CycleOf(cycle));
    sender.SendState(server, {"running", "load", cycle + 1, 3500, cycle, 0, {}, {}},
                     bench::UtcMilliseconds());
    ++load.sent;
  }
}

double Percentile(std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0.0;
  std::ranges::sort(sorted);
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

std::int64_t BytesOf(bench::Server& admin) {
  return admin.Run("SELECT pg_database_size('lab')").Integer(0, 0);
}

int Measure(int benches, double cycles_per_s, double seconds) {
  if (!HasPostgres()) {
    fmt::print("{}\n", kNoPostgres);
    return 0;
  }
  PostgresServer postgres({},
                          "fsync = on\nshared_buffers = 256MB\nmax_wal_size = 1GB\nmax_connections = 50\n");
  postgres.MakeLab();
  fmt::print("making {} benches\n", benches);
  MakeBenches(postgres, benches);
  // With a password, as in a lab: what it costs to check is a good part of a short connection.
  postgres.DemandPasswords("secret");
  bench::Server admin(postgres.Conninfo("admin"));
  const std::int64_t bytes_before = BytesOf(admin);
  Load load;
  const Clock::time_point begun = Clock::now();
  std::vector<std::thread> senders;
  for (int i = 0; i < kSenders; ++i)
    senders.emplace_back([&] { Send(postgres, benches, cycles_per_s, begun, load); });
  std::vector<double> list_ms;
  std::vector<double> compare_ms;
  const auto timed = [](std::vector<double>& into, const auto& ask) {
    const Clock::time_point asked = Clock::now();
    ask();
    into.push_back(1e3 * SecondsSince(asked));
  };
  // The first comparison asks for a quantity that there is.
  while (load.sent == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  while (SecondsSince(begun) < seconds) {
    timed(list_ms, [&] { bench::BenchesJson(admin, {.find = {}, .state = {}}); });
    timed(compare_ms, [&] {
      bench::ComparisonJson(admin, "quantity_03_Nm_per_rad", bench::ParseCampaignQuery("specimen=A00*"));
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  const double took_s = SecondsSince(begun);
  const std::int64_t sent = load.sent;
  load.end = true;
  for (std::thread& sender : senders) sender.join();
  const std::int64_t cycles = load.sent;
  const auto bytes = static_cast<double>(BytesOf(admin) - bytes_before) / static_cast<double>(cycles);
  const std::int64_t stored = admin.Run("SELECT count(*) FROM strainwave.cycles").Integer(0, 0);
  constexpr int kRowsPerCycle = kResultsPerCycle + kPhasesPerCycle + 3;
  fmt::print("asked for      {:8.1f} cycles/s of {} benches for {:.0f} s\n", cycles_per_s, benches, took_s);
  fmt::print("sustained      {:8.1f} cycles/s, {:.0f} journal rows/s\n", static_cast<double>(sent) / took_s,
             kRowsPerCycle * static_cast<double>(sent) / took_s);
  fmt::print("stored         {} of {} cycles; {} connections failed\n", stored, cycles, load.failed.load());
  fmt::print("bytes          {:.0f} a cycle; {:.2f} GB a day of 10000 benches with a cycle in 30 min\n",
             bytes, bytes * 10'000.0 * kSecondsPerDay / 1800.0 / 1e9);
  fmt::print("list of all    p50 {:.1f} ms, p99 {:.1f} ms, longest {:.1f} ms of {}\n",
             Percentile(list_ms, 0.5), Percentile(list_ms, 0.99), Percentile(list_ms, 1.0), list_ms.size());
  fmt::print("comparison     p50 {:.1f} ms, p99 {:.1f} ms, longest {:.1f} ms\n", Percentile(compare_ms, 0.5),
             Percentile(compare_ms, 0.99), Percentile(compare_ms, 1.0));
  return stored == cycles ? 0 : 1;
}

}  // namespace
}  // namespace strainwave

int main(int argc, char** argv) {
  const auto argument = [&](int place, double otherwise) {
    return argc > place ? std::strtod(argv[place], nullptr) : otherwise;
  };
  return strainwave::Measure(static_cast<int>(argument(1, 10'000)), argument(2, 10.0 * 10'000.0 / 1800.0),
                             argument(3, 60.0));
}
