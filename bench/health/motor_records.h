// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/features/packet_features.h"
#include "bench/records/record_reader.h"
#include "bench/records/record_warnings.h"

namespace strainwave::bench {

inline const std::vector<std::string> kMotorChannels{"current_A", "velocity_rad_per_s"};
/// Where neither the records nor their metadata tell it, with a warning.
inline constexpr double kAssumedMotorRate_hz = 1000.0;
/// A cycle of fewer rows has no bands to speak of.
inline constexpr std::size_t kFewestCycleRows = 32;

/// The features of the cycles of one record.
struct MotorFeatures {
  std::string file;
  double sample_rate_hz{};
  std::size_t shortest{};  // cycle, in rows
  std::size_t longest{};
  Eigen::MatrixXd values;                        // cycles × features
  std::string cut;                               // how, in words
  std::size_t floored{};                         // logarithms of coefficients that are zero
  std::vector<std::vector<double>> first_cycle;  // its channels, for pictures
  std::vector<RecordWarning> warnings;
};

/// Reads the motor records of a file, cuts each into cycles by its `state`, and computes the features of
/// current and velocity.
/// @throws BenchError, RecordError: a file of another kind, of another rate than `sample_rate_hz` (to a
///   hundredth, where it is given), uneven in time, or with a cycle that is too short.
std::vector<MotorFeatures> FeaturesOfMotorFile(const RecordReader& reader, const std::filesystem::path& path,
                                               analysis::features::PacketFeatures& features,
                                               std::optional<double> sample_rate_hz);

/// The cycles of the motor records of a file, a record each, in order, with `sample_rate_hz`.
/// @throws as above, but for the rate.
std::vector<daq::Record> ReadMotorCycles(const RecordReader& reader, const std::filesystem::path& path);

}  // namespace strainwave::bench
