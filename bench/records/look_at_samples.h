// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daq/record.h"

namespace strainwave::bench {

/// The look at its samples that a measured record gets before any command computes something of it, whatever
/// the command. What loggers do is found, told in the record's notes (rows from 1), and corrected:
/// - rows that were written twice, their time stamp too, count once;
/// - an angle that starts anew each turn (or part of one) goes on;
/// - time stamps that were rounded, or jitter within a tick of even samples, become even (vibration; an
/// axis's
///   own study does it for motion);
/// - of a channel that is written again until its next value comes only rows with a new value stay, at the
///   times when they came; a channel of a vibration that is held, or stands still, is left out;
/// - rows in which a channel repeats one value that its own noise would never let stand are left out;
/// - so are rows in which an axis' position or velocity stands off its neighbours alone;
/// - so are rows of a vibration in which the machine stands, before it runs or after;
/// - so is an axis' velocity whose range ends too soon, by the position beside it.
/// Told only: a torque beyond its sensor's range, steps of a loop's angle or torque that are coarse, an axis
/// that gives back work, a sweep that stands still for long (it counts by angle), stamps that repeat or
/// jitter.
/// @throws BenchError, `FILE:LINE: error: WHAT (what was expected)`, for what cannot be put right: a rate
///   that contradicts the time, steps of an angle too large to tell which way it went, hardly anything left,
///   and what `sweep_checks.h` refuses.
void LookAtSamples(daq::Record& record);

}  // namespace strainwave::bench
