// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/joint_dynamics/dynamics.h"
#include "daq/record.h"

namespace strainwave::bench {

/// How records of joints are smoothed: polynomials over a window that is told in seconds.
struct Smoothing {
  double window_s{0.051};
  int order{3};
  /// A window that a user gave is taken as it is, and must have an odd number of samples; that of the
  /// default, and of a model at another rate, becomes the nearest odd one.
  bool as_given{};
};

/// A record of joints, smoothed.
struct JointFile {
  std::filesystem::path path;
  analysis::joint_dynamics::JointMotion motion;
  double sample_rate_hz{};
  double duration_s{};           // of the shortest record
  int window{};                  // samples
  double half_power_hz{};        // what the smoothing leaves: −3 dB
  bool acceleration_measured{};  // there were columns of it; else it is the slope of the velocities'
                                 // polynomials
  std::vector<std::string> warnings;
};

/// Whether the record has accelerations; `kDerived` leaves them aside.
enum class Acceleration { kAsThere, kDerived };

/// Reads a file with one record of joints, or several, which are put one behind the other.
/// @throws BenchError (exit code 2), naming the file: another kind of record, times that do not go on evenly,
/// an even
///   window, fewer samples than two windows; daq::RecordError.
JointFile ReadJointFile(const std::filesystem::path& path, const Smoothing& smoothing,
                        Acceleration acceleration);

/// Smooths a record of joints.
/// @param smoothing  as if by default: `as_given` aside.
/// @param measured   its accelerations are taken as they stand; else the slope of the velocities'
///   polynomials.
/// @throws std::invalid_argument for fewer samples than the window.
analysis::joint_dynamics::JointMotion SmoothedMotion(const daq::Record& record, const Smoothing& smoothing,
                                                     double sample_rate_hz, Acceleration acceleration);

}  // namespace strainwave::bench
