// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daq/record.h"

/// What makes a record valid, whichever file it came from: docs/contract.md#record-files, and `history`, the
/// rows that a bench keeps around an event (`time_s` and any channels, in which a dead sensor may be NaN).
namespace strainwave::daq {

/// The part of a record that breaks a rule; each reader turns it into a place of its own.
struct RecordPart {
  enum class Level { kRecord, kKind, kMetadata, kColumn, kCell };
  Level level{};
  std::string name{};  // of the metadata key or of the column
  std::size_t row{};   // from 0; for cells
};

struct RuleBreak {
  RecordPart part;
  std::string what;
  std::string expected;
};

/// Every rule that `record` breaks; empty for a valid one. Rules: a known kind; the required columns; columns
/// of equal length with at least one row; numbers and directions where they belong; finite values in every
/// column that the kind knows, and in every channel of a vibration, within the bounds of their unit
/// (`value_bounds.h`), as the numbers of the metadata are; `time_s` that never decreases and goes on by at
/// least a nanosecond a row, if it does; a ratio other than zero; 0 < t1 < t2 < t3; positive inertia, mass
/// and sample rate; position, velocity and torque of each joint, numbered from 1; `absolute` true or false; one gain, not zero, for a current that stands in a torque's
/// place. A column gives at most `kMostBreaksPerColumn`.
std::vector<RuleBreak> CheckRecord(const Record& record);

/// The bounds alone, of all columns and metadata; NaN, what a dead sensor gave, keeps them.
std::vector<RuleBreak> CheckBounds(const Record& record);

inline constexpr std::size_t kMostBreaksPerColumn = 20;

/// How a message names the kinds.
inline constexpr std::string_view kKnownKinds =
    "transmission_error, hysteresis, motion, vibration, motor, joints or history";

/// True when the kind gives `column` a meaning, so that its values must be good. A vibration also takes any
/// further column as a channel, which this does not tell.
bool IsKnownColumn(const RecordKind& kind, std::string_view column);

/// True when a further column of numbers is a channel with rules of its own (vibration).
bool TakesFurtherChannels(const RecordKind& kind);

/// True for the columns that say where the input or the output shaft stands: beside accelerations they are no
/// channel.
bool IsShaftAngle(std::string_view column);

/// True when analysis reads the column as doubles; others keep the number type of their file.
bool IsReadAsDoubles(const RecordKind& kind, std::string_view column);

/// True for a motion record of a linear axis (`position_m`, `force_N`).
bool IsLinearAxis(const Record& record);

/// What one ampere of `current_A` is, in Nm (N for a linear axis), in a motion record that has the current in
/// place of `torque_Nm` (`force_N`): the one metadata whose key ends in `_Nm_per_A` (`_N_per_A`).
std::optional<double> CurrentGain(const Record& record);

/// The number under `key`; without it the default of docs/contract.md#record-files (`ratio` 80, `t1_Nm` 7,
/// `t2_Nm` 25, `t3_Nm` 34); else nothing.
std::optional<double> MetadataNumber(const Record& record, std::string_view key);

}  // namespace strainwave::daq
