// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/trigger.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "daq/acquisition/capture_file.h"
#include "daq/acquisition/gap_ledger.h"
#include "daq/acquisition/stream_file_reader.h"
#include "tests/daq/acquisition/sample_blocks.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::trigger_test {
namespace {

// Three pulses, each of 40 samples, that begin at samples 1000, 3000 and 3100.
double Pulses(std::uint64_t n, std::size_t channel) {
  if (channel == 1) return static_cast<double>(n);
  const bool is_high = (n >= 1000 && n < 1040) || (n >= 3000 && n < 3040) || (n >= 3100 && n < 3140);
  return is_high ? 10 : 0.5 * std::sin(static_cast<double>(n));
}

std::vector<Capture> CapturesOf(const TriggerSettings& settings, const std::vector<std::uint32_t>& blocks,
                                std::uint64_t begin = 0) {
  const SourceDescription source = SourceOf(2, 1000);
  TriggeredCapture trigger(source, settings);
  std::vector<Capture> captures;
  std::uint64_t n = begin;
  for (const std::uint32_t samples : blocks) {
    trigger.Take(BlockAt(source, n, samples, Pulses), [&](const Capture& c) { captures.push_back(c); });
    n += samples;
  }
  return captures;
}

void ExpectWhole(const Capture& capture, std::uint64_t trigger, std::uint64_t before, std::uint64_t after) {
  EXPECT_EQ(capture.trigger_sample, trigger);
  EXPECT_EQ(capture.trigger_row, before);
  EXPECT_EQ(capture.first_sample, trigger - before);
  ASSERT_EQ(capture.rows(), before + 1 + after);
  for (std::uint64_t row = 0; row < capture.rows(); ++row) {
    ASSERT_EQ(capture.Value(row, 1), static_cast<double>(trigger - before + row));
    ASSERT_EQ(capture.Value(row, 0), static_cast<float>(Pulses(trigger - before + row, 0)));
  }
}

TEST(Trigger, LosesNothingWhereverTheBordersOfBlocksLie) {
  const TriggerSettings settings{
      .kind = TriggerKind::kRising, .level = 5, .hysteresis = 1, .before = 70, .after = 90};
  std::mt19937 random(1);
  for (int run = 0; run < 60; ++run) {
    std::vector<std::uint32_t> blocks;
    for (std::uint32_t sum = 0; sum < 4000; sum += blocks.back()) {
      blocks.push_back(run == 0 ? 1U : run == 1 ? 4000U : static_cast<std::uint32_t>(1 + random() % 300));
    }
    const std::vector<Capture> captures = CapturesOf(settings, blocks);
    ASSERT_EQ(captures.size(), 3U) << run;
    ExpectWhole(captures[0], 1000, 70, 90);
    ExpectWhole(captures[1], 3000, 70, 90);
    ExpectWhole(captures[2], 3100, 70, 90);
    EXPECT_EQ(captures[0].cause, "a_V rises to 5");
    EXPECT_TRUE(captures[0].holes.empty());
  }
}

TEST(Trigger, HoldsOffAndCountsWhatItIgnores) {
  const std::vector<std::uint32_t> blocks(40, 100);
  const SourceDescription source = SourceOf(2, 1000);
  TriggeredCapture trigger(
      source, {.kind = TriggerKind::kRising, .level = 5, .before = 10, .after = 10, .hold_off = 101});
  int captures = 0;
  for (std::uint64_t n = 0; n < 4000; n += 100) {
    trigger.Take(BlockAt(source, n, 100, Pulses), [&](const Capture&) { ++captures; });
  }
  EXPECT_EQ(captures, 2);
  EXPECT_EQ(trigger.ignored(), 1U);
  EXPECT_EQ(CapturesOf({.kind = TriggerKind::kRising, .level = 5, .before = 10, .after = 10, .hold_off = 100},
                       blocks)
                .size(),
            3U);
}

TEST(Trigger, WantsTheHysteresisToBePassedBeforeItTriggersAgain) {
  const SourceDescription source = SourceOf(1, 1000);
  const auto triggers = [&](double hysteresis) {
    TriggeredCapture trigger(source, {.kind = TriggerKind::kRising, .level = 5, .hysteresis = hysteresis});
    std::vector<std::uint64_t> at;
    // A ripple of 1 about the level, twice down to 0.
    const auto signal = [](std::uint64_t n, std::size_t) {
      return n % 50 == 0 ? 0.0 : n % 2 == 0 ? 5.5 : 4.5;
    };
    trigger.Take(BlockAt(source, 0, 100, signal), [&](const Capture& c) { at.push_back(c.trigger_sample); });
    return at;
  };
  EXPECT_EQ(triggers(2), (std::vector<std::uint64_t>{2, 52}));
  EXPECT_EQ(triggers(0.5).size(), 48U);  // 4.5 is just half below: each ripple counts
}

// Three blocks of a stream of 1 kHz, of which 30 samples before the last never came.
std::vector<SampleBlock> BlocksWithAHole(const SourceDescription& source) {
  GapLedger ledger({}, 1000);
  std::vector<SampleBlock> blocks;
  for (const auto& [n, samples] : {std::pair{0U, 100U}, {100U, 60U}, {190U, 50U}}) {
    blocks.push_back(BlockAt(source, n, samples, Pulses));
    ledger.Admit(blocks.back());
  }
  return blocks;
}

TEST(Trigger, HandsOverWhatWasBeforeAnEventThatNothingFollowed) {
  const SourceDescription source = SourceOf(2, 1000);
  TriggeredCapture trigger(source, {.kind = TriggerKind::kEvent, .before = 70, .after = 90});
  std::vector<Capture> captures;
  const auto deliver = [&](const Capture& capture) { captures.push_back(capture); };
  trigger.Finish(deliver);
  trigger.Fire("trip");
  trigger.Finish(deliver);  // nothing has ever come
  EXPECT_TRUE(captures.empty());
  TriggeredCapture flowing(source, {.kind = TriggerKind::kEvent, .before = 70, .after = 90});
  for (const SampleBlock& block : BlocksWithAHole(source)) flowing.Take(block, deliver);
  flowing.Fire("trip");
  flowing.Finish(deliver);
  flowing.Finish(deliver);
  ASSERT_EQ(captures.size(), 1U);
  EXPECT_EQ(captures[0].cause, "trip");
  EXPECT_EQ(captures[0].rows(), 70U);
  EXPECT_EQ(captures[0].trigger_row, 70U);
  EXPECT_EQ(captures[0].trigger_sample, 240U);
  EXPECT_EQ(captures[0].Value(69, 1), 239.0);
}

TEST(Trigger, LeavesAFileInWhichEachSampleHasItsBlocksTimes) {
  const SourceDescription source = SourceOf(2, 1000);
  TriggeredCapture trigger(source, {.kind = TriggerKind::kEvent, .before = 110, .after = 20});
  const std::vector<SampleBlock> blocks = BlocksWithAHole(source);
  const ScratchFolder scratch;
  const auto path = scratch / "trip.h5";
  for (const SampleBlock& block : blocks) {
    if (&block == &blocks.back()) trigger.Fire("over_torque");
    trigger.Take(block, [&](const Capture& capture) {
      WriteCapture(path, source, capture, {{"specimen", "S1"}});
    });
  }
  const StreamFileReader file(path);
  ASSERT_EQ(file.rows(), 131U);
  for (const auto& [name, text] : Attributes{{"specimen", "S1"},
                                             {"trigger_cause", "over_torque"},
                                             {"trigger_sample", "190"},
                                             {"trigger_row", "110"}}) {
    EXPECT_EQ(std::ranges::count(file.attributes(), std::pair(name, text)), 1) << name;
  }
  const std::vector<double> numbers = file.Values(1);
  EXPECT_EQ(numbers[0], 50.0);
  EXPECT_EQ(numbers[109], 159.0);
  EXPECT_EQ(numbers[110], 190.0);
  // The first block is cut; each keeps what the device and this machine said of its time.
  ASSERT_EQ(file.blocks().size(), 3U);
  const std::uint64_t begins[] = {50, 100, 190};
  const std::uint32_t samples[] = {50, 60, 21};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(file.blocks()[i].first_sample, begins[i]);
    EXPECT_EQ(file.blocks()[i].device_counter, begins[i]);
    EXPECT_EQ(file.blocks()[i].samples, samples[i]);
    EXPECT_EQ(file.blocks()[i].device_time_ns, static_cast<std::int64_t>(begins[i]) * 1'000'000);
    EXPECT_EQ(file.blocks()[i].arrival_ns, blocks[i].header.arrival.count());
  }
  ASSERT_EQ(file.gaps().size(), 1U);
  EXPECT_EQ(file.gaps()[0].row, 110U);
  EXPECT_EQ(file.gaps()[0].first_lost, 160U);
  EXPECT_EQ(file.gaps()[0].lost, 30U);
  EXPECT_EQ(file.gaps()[0].is_exact, 1U);
}

TEST(Trigger, KnowsALevelFromAnEdge) {
  const std::vector<std::uint32_t> blocks(10, 100);
  // The stream begins within the first pulse.
  EXPECT_EQ(
      CapturesOf({.kind = TriggerKind::kAbove, .level = 5, .after = 5}, blocks, 1010).at(0).trigger_sample,
      1010U);
  EXPECT_TRUE(CapturesOf({.kind = TriggerKind::kRising, .level = 5, .after = 5}, blocks, 1010).empty());
  EXPECT_EQ(
      CapturesOf({.kind = TriggerKind::kFalling, .level = 5, .after = 5}, blocks, 1010).at(0).trigger_sample,
      1040U);
  EXPECT_EQ(
      CapturesOf({.kind = TriggerKind::kBelow, .level = 5, .after = 5}, blocks, 1010).at(0).trigger_sample,
      1040U);
  EXPECT_EQ(CapturesOf({.kind = TriggerKind::kAbove, .level = 5, .before = 9, .after = 5}, blocks, 1010)
                .at(0)
                .trigger_row,
            0U);
}

TEST(Trigger, MarksAGapInTheCaptureAndSeesNoEdgeAcrossIt) {
  const SourceDescription source = SourceOf(2, 1000);
  for (const std::uint64_t lost : {30U, 50U}) {
    TriggeredCapture trigger(source, {.kind = TriggerKind::kRising, .level = 5, .before = 40, .after = 20});
    GapLedger ledger({}, 1000);
    std::vector<Capture> captures;
    const auto take = [&](std::uint64_t n, std::uint32_t samples) {
      SampleBlock block = BlockAt(source, n, samples, Pulses);
      ledger.Admit(block);
      trigger.Take(block, [&](const Capture& c) { captures.push_back(c); });
    };
    take(0, 960);
    take(960 + lost, 200);  // from before the pulse, or from within it
    if (lost == 50) {
      EXPECT_TRUE(captures.empty());
      continue;
    }
    ASSERT_EQ(captures.size(), 1U);
    EXPECT_EQ(captures[0].trigger_row, 40U);
    EXPECT_EQ(captures[0].first_sample, 930U);
    ASSERT_EQ(captures[0].holes.size(), 1U);
    EXPECT_EQ(captures[0].holes[0].row, 30U);
    EXPECT_EQ(captures[0].holes[0].lost, 30U);
    EXPECT_EQ(captures[0].Value(29, 1), 959);
    EXPECT_EQ(captures[0].Value(30, 1), 990);
  }
}

TEST(Trigger, TakesAnEventFromOutsideAndWhatIsLeftAtTheEnd) {
  const SourceDescription source = SourceOf(2, 1000);
  TriggeredCapture trigger(source, {.kind = TriggerKind::kEvent, .before = 20, .after = 50});
  std::vector<Capture> captures;
  const auto deliver = [&](const Capture& c) { captures.push_back(c); };
  trigger.Take(BlockAt(source, 0, 100, Pulses), deliver);
  trigger.Fire("drive fault 0x7300");
  trigger.Take(BlockAt(source, 100, 30, Pulses), deliver);
  EXPECT_TRUE(captures.empty());
  trigger.Finish(deliver);
  ASSERT_EQ(captures.size(), 1U);
  EXPECT_EQ(captures[0].cause, "drive fault 0x7300");
  ExpectWhole(captures[0], 100, 20, 29);
}

TEST(Trigger, RefusesWhatCannotTrigger) {
  const SourceDescription source = SourceOf(2, 1000);
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { TriggeredCapture(source, {.channel = 2}); }),
            "channel = 2, but the source has 2");
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { TriggeredCapture(source, {.hysteresis = -1}); }),
            "level = 0 and hysteresis = -1 are not finite and not below zero");
}

}  // namespace
}  // namespace strainwave::daq::acquisition::trigger_test
