// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/diagnosis/motion/grid.h"
#include "analysis/diagnosis/motion/rows.h"

namespace strainwave::analysis::diagnosis {

/// Gives the points' acceleration back what smoothing of the path took from short acceleration transients of
/// it: from a ramp of a few samples, which is nothing beside the noise of a whole record and all there is
/// while it lasts. Half an octave at a time from the smoothing up to the low-pass; each as far as it stands
/// above its noise around a point (positive-part shrinkage; James & Stein, Berkeley Symposium 4 (1961) 361),
/// unless that would be noise in the torque. Only what shows in the bands that the smoothing left goes on
/// into those above.
/// @return how wrong the acceleration may still be at each point (standard deviation): by what an
/// acceleration transient has above
///   where noise hides it, as it goes on from band to band, and by what folds back from above half the
///   sampling rate.
std::vector<double> AddAccelerationTransients(const MotionSamples& samples, const MotionBandwidth& bandwidth,
                                              std::span<const PointLayout> layouts, MotionGrid& grid);

/// Takes out of the points' acceleration what is nothing but noise: half an octave at a time from the
/// smoothing upwards, where a band stays at its noise and the torque does not follow it. Motion that is fast
/// only for moments keeps the smoothing narrow for the whole record otherwise, and the noise of the long calm
/// between them shows in the torque.
/// @return standard deviation of the noise that is left at each point
std::vector<double> CalmAcceleration(const MotionSamples& samples, const MotionBandwidth& bandwidth,
                                     std::span<const PointLayout> layouts, MotionGrid& grid);

/// Size of the acceleration around each point in the last half octave that the smoothing of the path leaves:
/// its noise, and more where the acceleration jumps. Infinite next to a segment's ends, where nobody knows.
std::vector<double> LastBand(const MotionSamples& samples, const MotionBandwidth& bandwidth,
                             std::span<const PointLayout> layouts, const MotionGrid& grid);

}  // namespace strainwave::analysis::diagnosis
