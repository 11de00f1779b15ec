// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/source_states.h"

#include <fstream>

#include <gtest/gtest.h>

#include "bench/utc.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::source_states_test {
namespace {

constexpr std::int64_t kNow_ms = 1'772'366'400'000;

BenchDescription Bench() {
  BenchDescription bench;
  bench.channels = {{"input_angle", "encoders", "a"},
                    {"gear_temperature", "thermometers", "t"},
                    {"output_angle", "encoders", "b"}};
  return bench;
}

SourceTotals Totals(std::uint64_t received, std::uint64_t lost, std::string trouble = "") {
  SourceTotals totals;
  totals.name = "encoders";
  totals.samples.received = received;
  totals.samples.lost = lost;
  totals.samples.gaps = lost > 0 ? 1 : 0;
  totals.trouble = std::move(trouble);
  return totals;
}

LiveSources Live(const SourceWatch& watch, std::int64_t utc_ms) {
  return {kNow_ms - 3'600'000, {utc_ms, utc_ms, 7}, watch.sources()};
}

std::vector<SourceState> StatesOf(const SourceWatch& watch, std::int64_t utc_ms,
                                  const std::vector<ChannelTrouble>& bad = {}, bool is_running = true) {
  return SourceStates(Bench(), bad, Live(watch, utc_ms), is_running, {utc_ms, utc_ms, 7});
}

TEST(SourceStates, AreOfEachDeviceInTheOrderOfTheBenchFile) {
  SourceWatch watch;
  watch.Look(std::vector{Totals(1000, 0)}, kNow_ms);
  const auto states = StatesOf(watch, kNow_ms);
  ASSERT_EQ(states.size(), 2U);
  EXPECT_EQ(states[0].source, "encoders");
  EXPECT_EQ(states[0].channels, (std::vector<std::string>{"input_angle", "output_angle"}));
  EXPECT_EQ(NameOf(states[0].condition), "good");
  EXPECT_EQ(states[0].words, "");
  EXPECT_EQ(states[0].counts->samples.received, 1000U);
  EXPECT_EQ(states[1].source, "thermometers");
  EXPECT_EQ(NameOf(states[1].condition), "good");
  EXPECT_FALSE(states[1].counts);
  BenchDescription simulated;
  simulated.simulated = true;
  const auto one = SourceStates(simulated, {}, std::nullopt, true, {});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].source, "simulated bench");
  EXPECT_EQ(NameOf(one[0].condition), "good");
}

TEST(SourceStates, SayWhatWasLostAndWhenAndForgiveAfterAMinute) {
  SourceWatch watch;
  watch.Look(std::vector{Totals(1000, 0)}, kNow_ms);
  watch.Look(std::vector{Totals(1900, 100)}, kNow_ms + 1000);
  const auto losing = StatesOf(watch, kNow_ms + 1000)[0];
  EXPECT_EQ(NameOf(losing.condition), "losing samples");
  EXPECT_EQ(losing.words, "100 of 2000 samples lost in 1 gaps, the last at " + UtcText(kNow_ms + 1000));
  watch.Look(std::vector{Totals(9900, 100)}, kNow_ms + 62'000);
  const auto good = StatesOf(watch, kNow_ms + 62'000)[0];
  EXPECT_EQ(NameOf(good.condition), "good");
  EXPECT_EQ(good.counts->last_loss_utc_ms, kNow_ms + 1000);
  EXPECT_FALSE(good.words.empty());
}

TEST(SourceStates, SayWhatIsSilentOrInTrouble) {
  SourceWatch watch;
  watch.Look(std::vector{Totals(0, 0)}, kNow_ms);
  EXPECT_EQ(StatesOf(watch, kNow_ms)[0].words, "nothing has come of it yet");
  watch.Look(std::vector{Totals(1000, 0)}, kNow_ms);
  watch.Look(std::vector{Totals(1000, 0)}, kNow_ms + 6000);
  const auto silent = StatesOf(watch, kNow_ms + 6000)[0];
  EXPECT_EQ(NameOf(silent.condition), "silent");
  EXPECT_EQ(silent.words, "nothing has come since " + UtcText(kNow_ms));
  watch.Look(std::vector{Totals(1000, 0, "the connection is refused")}, kNow_ms + 7000);
  const auto trouble = StatesOf(watch, kNow_ms + 7000)[0];
  EXPECT_EQ(NameOf(trouble.condition), "trouble");
  EXPECT_EQ(trouble.words, "the connection is refused");
  const auto bad = StatesOf(watch, kNow_ms,
                            {{"gear_temperature", "thermometers: not connected", "2026-03-01T12:00:00Z"}})[1];
  EXPECT_EQ(NameOf(bad.condition), "trouble");
  EXPECT_EQ(bad.words,
            "gear_temperature gives no value since 2026-03-01T12:00:00Z: thermometers: not connected");
}

TEST(SourceStates, AreNotOfNowWhereNobodyRunsOrTheRunIsHeldUp) {
  SourceWatch watch;
  watch.Look(std::vector{Totals(1900, 100)}, kNow_ms);
  for (const SourceState& state : StatesOf(watch, kNow_ms, {}, false)) {
    EXPECT_EQ(NameOf(state.condition), "not running");
  }
  const Moment later{kNow_ms + 30'000, kNow_ms + 30'000, 7};
  const auto held_up = SourceStates(Bench(), {}, Live(watch, kNow_ms), true, later)[0];
  EXPECT_EQ(NameOf(held_up.condition), "silent");
  EXPECT_TRUE(held_up.words.starts_with("the program that runs the campaign has said nothing of it since " +
                                        UtcText(kNow_ms)))
      << held_up.words;
}

TEST(LiveSourcesFile, ShowsWhatCameOfEachSourceAndStays) {
  const daq::ScratchFolder scratch;
  const auto path = scratch.path() / "sources";
  std::ofstream(path) << "half a file";
  EXPECT_FALSE(ReadLiveSources(path));
  {
    LiveSourcesFile file(path);
    file.Show({}, {kNow_ms, 0, 7});
    EXPECT_FALSE(ReadLiveSources(path));
    file.Show(std::vector{Totals(1000, 0)}, {kNow_ms, 5000, 7});
    // Within a second nothing is written.
    file.Show(std::vector{Totals(1100, 0)}, {kNow_ms + 500, 5500, 7});
    EXPECT_EQ(ReadLiveSources(path)->sources[0].samples.received, 1000U);
    file.Show(std::vector{Totals(1900, 100, "late")}, {kNow_ms + 1000, 6000, 7});
  }
  const auto live = ReadLiveSources(path);
  ASSERT_TRUE(live);
  EXPECT_EQ(live->since_utc_ms, kNow_ms);
  EXPECT_EQ(live->taken.utc_ms, kNow_ms + 1000);
  ASSERT_EQ(live->sources.size(), 1U);
  EXPECT_EQ(live->sources[0].samples, Totals(1900, 100).samples);
  EXPECT_EQ(live->sources[0].trouble, "late");
  EXPECT_EQ(live->sources[0].last_loss_utc_ms, kNow_ms + 1000);
  // The next run counts from its own beginning.
  LiveSourcesFile next(path);
  next.Show(std::vector{Totals(5, 0)}, {kNow_ms + 9000, 9000, 7});
  EXPECT_EQ(ReadLiveSources(path)->since_utc_ms, kNow_ms + 9000);
  LiveSourcesFile nowhere("/nowhere/sources");
  nowhere.Show(std::vector{Totals(5, 0)}, {kNow_ms, 0, 7});
}

}  // namespace
}  // namespace strainwave::bench::source_states_test
