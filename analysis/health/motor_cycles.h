// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace strainwave::analysis::health {

/// Rows of one cycle of a robot.
struct CycleRows {
  std::size_t begin{};
  std::size_t count{};
};

struct MotorCycles {
  std::vector<CycleRows> cycles;
  int moves_a_cycle{};  // 0: the record is taken whole
  std::string note;     // how the record was cut, in words
};

/// Cuts a record at the rising edges of a signal that tells operation (above its least value) from rest. A
/// cycle is as many moves as it takes the shaft to come back: 2 for there and back, 1 where it goes on in one
/// sense. What comes before the first edge and after the last whole cycle is left out. A record with one
/// cycle, or whose signal never changes, is taken whole.
///
/// @param state  a value a row; empty: the record is one cycle.
/// @param velocity  a value a row.
MotorCycles CutCycles(std::span<const double> state, std::span<const double> velocity);

}  // namespace strainwave::analysis::health
