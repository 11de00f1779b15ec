// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/window.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <gtest/gtest.h>

namespace strainwave::bench::monitor_window_test {
namespace {

constexpr double kRate_hz = 1000.0;
constexpr std::int64_t kSample_ns = 1'000'000;

// Samples that are their own numbers, so that each can be found again.
VibrationChunk Numbers(int from, int to) {
  VibrationChunk chunk;
  chunk.time_ns = from * kSample_ns;
  chunk.sample_rate_hz = kRate_hz;
  chunk.channels = {"a", "trigger_V"};
  chunk.samples.resize(2);
  for (int i = from; i < to; ++i) {
    chunk.samples[0].push_back(i);
    chunk.samples[1].push_back(0.0);
  }
  chunk.origin = "here";
  return chunk;
}

void ExpectNumbers(const VibrationWindow& window, int from, int to) {
  ASSERT_FALSE(window.fault) << window.fault->text;
  ASSERT_EQ(window.samples[0].size(), static_cast<std::size_t>(to - from));
  EXPECT_EQ(window.samples[0].front(), from);
  EXPECT_EQ(window.samples[0].back(), to - 1);
  EXPECT_EQ(window.begin_ns, from * kSample_ns);
  EXPECT_EQ(window.end_ns, to * kSample_ns);
  EXPECT_EQ(window.origin, "here");
}

WindowRule ByEdge(std::size_t samples) {
  WindowRule rule;
  rule.by = WindowRule::By::kTrigger;
  rule.trigger_channel = "trigger_V";
  rule.trigger_level = 2.5;
  rule.trigger_samples = samples;
  return rule;
}

WindowRule ByTurns(double turns) {
  WindowRule rule;
  rule.by = WindowRule::By::kRevolution;
  rule.turns = turns;
  return rule;
}

TEST(WindowCutter, GivesAMarkedMeasurementWhole) {
  WindowCutter cutter({});
  VibrationChunk first = Numbers(0, 10);
  first.begins_measurement = true;
  VibrationChunk last = Numbers(10, 25);
  last.ends_measurement = true;
  EXPECT_TRUE(cutter.Add(first).empty());
  const auto windows = cutter.Add(last);
  ASSERT_EQ(windows.size(), 1U);
  ExpectNumbers(windows[0], 0, 25);
  EXPECT_TRUE(cutter.Add(Numbers(25, 40)).empty()) << "samples between measurements belong to none";
}

// A hundredth of a turn of the output a sample, of which the input makes four: 25 samples a turn.
TEST(WindowCutter, TellsTheSpeedOfTheInputShaftWhereItIsSteady) {
  WindowRule rule;
  rule.ratio = 4.0;
  const auto samples_per_turn = [&](const std::function<double(double)>& turns) {
    WindowCutter cutter(rule);
    VibrationChunk chunk = Numbers(0, 200);
    chunk.begins_measurement = chunk.ends_measurement = true;
    for (int i = 0; i < 200; ++i) chunk.output_turns.push_back(turns(i));
    return cutter.Add(chunk).at(0).samples_per_turn;
  };
  EXPECT_NEAR(samples_per_turn([](double i) { return 7.0 + i / 100.0; }).value(), 25.0, 1e-9);
  EXPECT_NEAR(samples_per_turn([](double i) { return -i / 100.0; }).value(), 25.0, 1e-9);
  EXPECT_EQ(samples_per_turn([](double i) { return i / 100.0 * (1.0 + i / 4000.0); }), std::nullopt);
  EXPECT_EQ(samples_per_turn([](double) { return 7.0; }), std::nullopt) << "a shaft at rest has no orders";
  WindowCutter cutter(rule);
  VibrationChunk chunk = Numbers(0, 200);
  chunk.begins_measurement = chunk.ends_measurement = true;
  EXPECT_EQ(cutter.Add(chunk).at(0).samples_per_turn, std::nullopt) << "nothing is known of the shaft";
}

TEST(WindowCutter, BeginsAtARisingEdgeWhereverTheBlocksLie) {
  for (int block = 1; block < 40; ++block) {
    WindowCutter cutter(ByEdge(10));
    std::vector<VibrationWindow> windows;
    for (int from = 0; from < 60; from += block) {
      VibrationChunk chunk = Numbers(from, std::min(from + block, 60));
      for (std::size_t i = 0; i < chunk.samples[1].size(); ++i) {
        const int at = from + static_cast<int>(i);
        // High from the start (no edge), a pulse at 12, another within its window, one at 40.
        const bool high = at < 5 || (at >= 12 && at < 15) || at == 18 || at >= 40;
        chunk.samples[1][i] = high ? 5.0 : 0.0;
      }
      for (VibrationWindow& window : cutter.Add(chunk)) windows.push_back(std::move(window));
    }
    ASSERT_EQ(windows.size(), 2U) << "in blocks of " << block;
    ExpectNumbers(windows[0], 12, 22);
    ExpectNumbers(windows[1], 40, 50);
  }
}

TEST(WindowCutter, SaysOnceThatTheTriggerIsNotThere) {
  WindowCutter cutter(ByEdge(10));
  VibrationChunk chunk = Numbers(0, 10);
  chunk.channels[1] = "other";
  const auto windows = cutter.Add(chunk);
  ASSERT_EQ(windows.size(), 1U);
  EXPECT_EQ(windows[0].fault->kind, SignalFaultKind::kMissingChannel);
  EXPECT_EQ(windows[0].fault->text, "there is no channel trigger_V (expected the trigger)");
  EXPECT_TRUE(cutter.Add(chunk).empty());
}

TEST(WindowCutter, CutsATurnAtATimeInEitherDirection) {
  for (const double direction : {1.0, -1.0}) {
    WindowCutter cutter(ByTurns(2.0));
    std::vector<VibrationWindow> windows;
    for (int from = 0; from < 1000; from += 64) {
      VibrationChunk chunk = Numbers(from, from + 64);
      for (int i = from; i < from + 64; ++i) chunk.output_turns.push_back(7.3 + direction * i / 128.0);
      for (VibrationWindow& window : cutter.Add(chunk)) windows.push_back(std::move(window));
    }
    ASSERT_EQ(windows.size(), 3U);
    ExpectNumbers(windows[0], 0, 256);
    ExpectNumbers(windows[1], 256, 512);
    ExpectNumbers(windows[2], 512, 768);
    EXPECT_TRUE(cutter.Finish().empty());
  }
}

// Of one record, in blocks of some length.
std::vector<VibrationWindow> CutInBlocks(const WindowRule& rule, int rows, int block,
                                         std::optional<double> samples_per_turn, double rate_hz = kRate_hz) {
  WindowCutter cutter(rule);
  std::vector<VibrationWindow> windows;
  for (int from = 0; from < rows; from += block) {
    const int to = std::min(from + block, rows);
    VibrationChunk chunk = Numbers(from, to);
    chunk.sample_rate_hz = rate_hz;
    chunk.time_ns = std::llround(from * 1e9 / rate_hz);
    chunk.begins_measurement = from == 0;
    chunk.ends_measurement = to == rows;
    for (int i = from; samples_per_turn && i < to; ++i)
      chunk.output_turns.push_back(0.25 + i / (*samples_per_turn * rule.ratio));
    for (VibrationWindow& window : cutter.Add(chunk)) windows.push_back(std::move(window));
  }
  EXPECT_TRUE(cutter.Finish().empty()) << "what is left at the end is no fault";
  return windows;
}

TEST(WindowCutter, ByTrainingGivesTheWindowsThatTrainingHad) {
  WindowRule rule;
  rule.ratio = 80.0;
  for (const WindowLength length :
       {WindowLength{.samples = 0, .turns = 3}, WindowLength{.samples = 70, .turns = 0}}) {
    rule.length = length;
    for (const double samples_per_turn : {25.0, 33.4, 41.0 / 3.0}) {
      for (const int rows : {900, 980, 1000}) {  // the first two end with a window
        const auto expected = WindowsOf(static_cast<std::size_t>(rows), samples_per_turn, length);
        for (const int block : {1, 64, rows}) {
          const auto windows = CutInBlocks(rule, rows, block, samples_per_turn);
          ASSERT_EQ(windows.size(), expected.size()) << samples_per_turn << " of " << rows;
          for (std::size_t k = 0; k < windows.size(); ++k) {
            ASSERT_FALSE(windows[k].fault);
            EXPECT_EQ(windows[k].samples[0].front(), static_cast<double>(expected[k].begin));
            EXPECT_EQ(windows[k].samples[0].size(), expected[k].count) << samples_per_turn << " " << k;
          }
        }
      }
    }
  }
}

TEST(WindowCutter, ByTrainingBeginsAnewWithEachMeasurement) {
  WindowRule rule;
  rule.length.samples = 40;
  WindowCutter cutter(rule);
  std::vector<double> begins;
  for (const int from : {0, 100}) {
    VibrationChunk chunk = Numbers(from, from + 100);
    chunk.begins_measurement = chunk.ends_measurement = true;
    for (const VibrationWindow& window : cutter.Add(chunk)) begins.push_back(window.samples[0].front());
  }
  EXPECT_EQ(begins, (std::vector<double>{0, 40, 100, 140}));
}

TEST(WindowCutter, NumbersOfSamplesHoldAtTheRateOfTheTraining) {
  WindowRule rule;
  rule.length.samples = 40;
  rule.sample_rate_hz = kRate_hz;
  const auto windows = CutInBlocks(rule, 250, 64, std::nullopt, 3 * kRate_hz);
  ASSERT_EQ(windows.size(), 2U);
  EXPECT_EQ(windows[1].samples[0].front(), 120.0);
  EXPECT_EQ(windows[1].samples[0].size(), 120U);
}

TEST(WindowCutter, OneLostSampleThatIsCountedBreaksTheWindow) {
  WindowRule rule;
  rule.length.samples = 40;
  WindowCutter cutter(rule);
  VibrationChunk first = Numbers(0, 30);
  first.is_counted = true;
  EXPECT_TRUE(cutter.Add(first).empty());
  VibrationChunk next = Numbers(30, 80);
  next.is_counted = true;
  next.gap = "1 samples were lost";
  const auto windows = cutter.Add(next);
  ASSERT_EQ(windows.size(), 2U);
  EXPECT_EQ(windows[0].fault->kind, SignalFaultKind::kGap);
  EXPECT_EQ(windows[0].fault->text, "1 samples were lost (expected the whole window)");
  EXPECT_TRUE(windows[0].samples.empty());
  ExpectNumbers(windows[1], 30, 70);
  VibrationChunk late = Numbers(80, 110);
  late.is_counted = true;
  late.time_ns += 1000 * kSample_ns;
  const auto whole = cutter.Add(late);
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_FALSE(whole[0].fault) << "where samples are counted, times tell nothing of gaps";
}

TEST(WindowCutter, NoWindowGoesOnIntoAnotherMeasurement) {
  for (const bool by_edge : {true, false}) {
    WindowCutter cutter(by_edge ? ByEdge(50) : ByTurns(1.0));
    std::vector<VibrationWindow> windows;
    for (const int from : {0, 40, 80}) {
      VibrationChunk chunk = Numbers(from, from + 40);
      chunk.begins_measurement = chunk.ends_measurement = true;
      chunk.samples[1][20] = 5.0;
      for (int i = 0; i < 40; ++i) chunk.output_turns.push_back(0.02 * (from + i));
      for (VibrationWindow& window : cutter.Add(chunk)) windows.push_back(std::move(window));
    }
    for (const VibrationWindow& window : windows)
      EXPECT_EQ(window.fault->text, "another measurement began (expected the whole window)");
    EXPECT_EQ(windows.size(), by_edge ? 2U : 0U);
  }
}

TEST(WindowCutter, AnAngleThatIsLostBreaksTheTurn) {
  WindowCutter cutter(ByTurns(1.0));
  VibrationChunk chunk = Numbers(0, 40);
  for (int i = 0; i < 40; ++i) chunk.output_turns.push_back(0.02 * i);
  EXPECT_TRUE(cutter.Add(chunk).empty());
  const auto windows = cutter.Add(Numbers(40, 80));
  ASSERT_EQ(windows.size(), 2U);
  EXPECT_EQ(windows[0].fault->text,
            "the angle of the output shaft is not known any more (expected the whole window)");
  EXPECT_EQ(windows[1].fault->kind, SignalFaultKind::kMissingChannel);
}

TEST(WindowCutter, AShaftThatTurnsBackMakesNoTurn) {
  WindowCutter cutter(ByTurns(1.0));
  VibrationChunk chunk = Numbers(0, 100);
  for (int i = 0; i < 100; ++i) chunk.output_turns.push_back(i < 60 ? 0.01 * i : 1.2 - 0.01 * i);
  const auto windows = cutter.Add(chunk);
  ASSERT_EQ(windows.size(), 1U);
  EXPECT_EQ(windows[0].fault->text, "the shaft turned back (expected a turn in one direction)");
}

TEST(WindowCutter, WithoutAnAngleThereIsNoTurn) {
  WindowCutter cutter(ByTurns(1.0));
  const auto windows = cutter.Add(Numbers(0, 10));
  ASSERT_EQ(windows.size(), 1U);
  EXPECT_EQ(windows[0].fault->kind, SignalFaultKind::kMissingChannel);
}

TEST(WindowCutter, AGapBreaksTheWindowAndIsNotBridged) {
  for (const int lost : {5, 500}) {
    WindowCutter cutter({});
    VibrationChunk first = Numbers(0, 10);
    first.begins_measurement = true;
    cutter.Add(first);
    VibrationChunk last = Numbers(10 + lost, 25 + lost);
    last.ends_measurement = true;
    const auto windows = cutter.Add(last);
    ASSERT_EQ(windows.size(), 1U);
    EXPECT_EQ(windows[0].fault->kind, SignalFaultKind::kGap);
    EXPECT_TRUE(windows[0].samples.empty());
  }
}

TEST(WindowCutter, JitterOfTimeStampsIsNoGap) {
  WindowCutter cutter({});
  VibrationChunk first = Numbers(0, 10);
  first.begins_measurement = true;
  cutter.Add(first);
  VibrationChunk last = Numbers(10, 25);
  last.time_ns += 3 * kSample_ns;
  last.ends_measurement = true;
  const auto windows = cutter.Add(last);
  ASSERT_EQ(windows.size(), 1U);
  EXPECT_FALSE(windows[0].fault);
}

TEST(WindowCutter, AnotherRateOrOtherChannelsBreakTheWindow) {
  for (const bool rate : {true, false}) {
    WindowCutter cutter({});
    VibrationChunk first = Numbers(0, 10);
    first.begins_measurement = true;
    cutter.Add(first);
    VibrationChunk next = Numbers(10, 25);
    if (rate) next.sample_rate_hz *= 2.0;
    if (!rate) next.channels[0] = "b";
    const auto windows = cutter.Add(next);
    ASSERT_EQ(windows.size(), 1U);
    EXPECT_EQ(windows[0].fault->kind, SignalFaultKind::kGap);
  }
}

TEST(WindowCutter, TroubleOfTheSourceIsAWindowThatIsNotGood) {
  WindowCutter cutter({});
  VibrationChunk first = Numbers(0, 10);
  first.begins_measurement = true;
  cutter.Add(first);
  VibrationChunk trouble;
  trouble.trouble = "no such file (expected a record)";
  const auto windows = cutter.Add(trouble);
  ASSERT_EQ(windows.size(), 2U);
  EXPECT_EQ(windows[0].fault->kind, SignalFaultKind::kGap);
  EXPECT_EQ(windows[1].fault->kind, SignalFaultKind::kUnreadable);
  EXPECT_EQ(windows[1].fault->text, trouble.trouble);
  EXPECT_EQ(cutter.Add(trouble).size(), 1U) << "each one is told";
}

TEST(WindowCutter, AWindowThatNeverEndsDoesNotFillTheMemory) {
  WindowRule rule;
  rule.most_samples = 100;
  WindowCutter cutter(rule);
  VibrationChunk chunk = Numbers(0, 60);
  chunk.begins_measurement = true;
  EXPECT_TRUE(cutter.Add(chunk).empty());
  const auto windows = cutter.Add(Numbers(60, 120));
  ASSERT_EQ(windows.size(), 1U);
  EXPECT_EQ(windows[0].fault->text,
            "the window does not end within 100 samples (expected the next trigger, or a shaft that turns)");
}

TEST(WindowCutter, ATurnThatWasGivenUpIsNotGoneOnWithInItsMiddle) {
  WindowRule rule = ByTurns(1.0);
  rule.most_samples = 100;
  WindowCutter cutter(rule);
  VibrationChunk stops = Numbers(0, 125);
  for (int i = 0; i < 125; ++i) stops.output_turns.push_back(0.02 * std::min(i, 25));
  ASSERT_EQ(cutter.Add(stops).size(), 1U);
  VibrationChunk turns = Numbers(125, 200);
  for (int i = 0; i < 75; ++i) turns.output_turns.push_back(0.5 + 0.02 * i);
  const auto windows = cutter.Add(turns);
  ASSERT_EQ(windows.size(), 1U);
  ExpectNumbers(windows[0], 125, 175);
}

TEST(WindowCutter, TheEndOfTheStreamCompletesNothing) {
  WindowCutter cutter({});
  VibrationChunk first = Numbers(0, 10);
  first.begins_measurement = true;
  cutter.Add(first);
  const auto windows = cutter.Finish();
  ASSERT_EQ(windows.size(), 1U);
  EXPECT_EQ(windows[0].fault->text, "the stream ended (expected the whole window)");
}

}  // namespace
}  // namespace strainwave::bench::monitor_window_test
