// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daq/record.h"

/// The parts of the look at a record's samples (look_at_samples.h).
namespace strainwave::bench {

/// Adds a note about the row, from 0.
void NoteAt(daq::Record& record, std::size_t row, std::string text);
/// Adds a note about the record.
void NoteOn(daq::Record& record, std::string text);

/// Only the rows marked, of all columns.
void KeepRows(daq::Record& record, const std::vector<bool>& kept);

/// Rows that were written twice.
void LookAtRepeatedRows(daq::Record& record);
/// Time stamps, and a rate beside them.
void LookAtTime(daq::Record& record);
/// Angles that start anew.
void LookAtAngles(daq::Record& record);
/// Steps that are coarse, a range that ends too soon, and work that goes the wrong way.
void LookAtSteps(daq::Record& record);
/// Single samples of an axis' position or velocity that stand off all others.
void LookAtOutliers(daq::Record& record);
/// A velocity whose range ends too soon, by the position beside it.
void LookAtVelocity(daq::Record& record);
/// Channels that are held or stand still.
void LookAtStandstill(daq::Record& record);
/// Rows of a vibration in which the machine does not run.
void LookAtRunning(daq::Record& record);

}  // namespace strainwave::bench
