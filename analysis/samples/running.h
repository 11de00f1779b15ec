// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis::samples {

/// Rows from `first` to before `end`.
struct Segment {
  std::size_t first{};
  std::size_t end{};

  bool operator==(const Segment&) const = default;
};

/// The longest segment in which a shaft turns, by its measured speed: it stands below a hundredth of the
/// largest. All rows where it stands in fewer than a fiftieth of them, as it does in a run-up from rest.
/// @param speed  one a row, of either sign.
Segment TurningBySpeed(std::span<const double> speed);

/// The same by what the shaft does to sensors on its housing, at a speed that is stated for the record: its
/// lines at 1 and 2 per turn stand clear of the noise in all but some blocks of whole turns, in which they
/// are no more than the noise: three in one piece, or at an end of the record one, where the lines are very
/// clear. Rows that are partly in such a block are none. All rows where no lines stand clear.
/// @param channels       of one length.
/// @param rows_per_turn  at least 4.
Segment TurningByLines(std::span<const std::vector<double>> channels, double rows_per_turn);

}  // namespace strainwave::analysis::samples
