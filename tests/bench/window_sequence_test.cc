// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/window_sequence.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::bench::window_sequence_test {
namespace {

// "0+3 3+3": where each window begins, and how many samples it has.
std::string Text(const std::vector<Window>& windows) {
  std::string text;
  for (const Window& window : windows) {
    text += (text.empty() ? "" : " ") + std::to_string(window.begin) + "+" + std::to_string(window.count);
  }
  return text;
}

std::vector<Window> Cut(double length, const std::vector<double>& positions) {
  WindowSequence sequence(length);
  std::vector<Window> windows;
  for (const double position : positions) {
    if (const auto ended = sequence.Add(position)) windows.push_back(*ended);
  }
  if (const auto last = sequence.Finish()) windows.push_back(*last);
  return windows;
}

TEST(WindowsOf, AreOfWholeSamplesOrOfTheNearestOnesToWholeTurns) {
  EXPECT_EQ(Text(WindowsOf(10, std::nullopt, {.samples = 3, .turns = 0})), "0+3 3+3 6+3");
  EXPECT_EQ(Text(WindowsOf(9, std::nullopt, {.samples = 3, .turns = 0})), "0+3 3+3 6+3");
  // Ends at 12.4, 24.8, 37.2 and 49.6 samples.
  EXPECT_EQ(Text(WindowsOf(49, 6.2, {.samples = 0, .turns = 2})), "0+12 12+12 25+12 37+12");
  EXPECT_EQ(Text(WindowsOf(48, 6.2, {.samples = 0, .turns = 2})), "0+12 12+12 25+12");
  // An end between two samples: the later one begins the next window.
  EXPECT_EQ(Text(WindowsOf(30, 10.5, {.samples = 0, .turns = 1})), "0+10 11+10");
}

TEST(WindowsOf, IsTheRecordWholeWithoutALengthAndNothingOfAShortOne) {
  EXPECT_EQ(Text(WindowsOf(7, std::nullopt, {})), "0+7");
  EXPECT_EQ(Text(WindowsOf(2, std::nullopt, {.samples = 3, .turns = 0})), "");
  EXPECT_EQ(Text(WindowsOf(100, std::nan(""), {.samples = 0, .turns = 1})), "");
  EXPECT_EQ(Text(WindowsOf(100, 0.1, {.samples = 0, .turns = 1})), "");
  EXPECT_THROW(WindowsOf(100, std::nullopt, {.samples = 0, .turns = 1}), std::invalid_argument);
}

TEST(WindowSequence, KnowsEvenTurnsBySamplesThatFitWhole) {
  std::vector<double> turns;
  for (int i = 0; i < 60; ++i) turns.push_back(7.25 + i / 12.4);
  EXPECT_EQ(Text(Cut(1.0, turns)), "0+12 12+12 25+12 37+12");
}

// 20 samples a turn, then 10.
TEST(WindowSequence, GoesOnToTheNextWindowWhereTurnsAreUneven) {
  std::vector<double> turns;
  for (int i = 0; i < 60; ++i) turns.push_back(i < 30 ? 0.05 * i : 1.5 + 0.1 * (i - 30));
  EXPECT_EQ(Text(Cut(1.0, turns)), "0+20 20+15 35+10 45+10");
}

TEST(SamplesPerUnit, IsKnownOfEvenPositionsAlone) {
  EXPECT_EQ(SamplesPerUnit(std::vector{0.0, 0.25, 0.5}), 4.0);
  EXPECT_EQ(SamplesPerUnit(std::vector{0.0, -0.25, -0.5}), 4.0);
  EXPECT_EQ(SamplesPerUnit(std::vector{0.0, 0.25, 0.6}), std::nullopt);
  EXPECT_EQ(SamplesPerUnit(std::vector{0.0, 0.0, 0.0}), std::nullopt);
  EXPECT_EQ(SamplesPerUnit(std::vector{1.0}), std::nullopt);
}

}  // namespace
}  // namespace strainwave::bench::window_sequence_test
