// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "bench/configuration/bench_description.h"
#include "bench/controller/phase_program.h"
#include "bench/roles/channel_calibration.h"

namespace strainwave::bench {

/// What the bench file says of its sensors: torque transducer, encoders, accelerometers.
std::vector<ChannelCalibration> CalibrationsOf(const BenchDescription& bench);

/// A calibration that does not hold today.
struct CalibrationTrouble {
  std::string channel;
  std::string words;  // which, of which sensor, since when
};

/// The channels whose calibration is expired, not yet made, or of another sensor than the one mounted, as the
/// bench file and the devices themselves have it; one a channel. A channel without a calibration is none of
/// them: its data say "none".
std::vector<CalibrationTrouble> CalibrationTroubles(std::span<const ChannelCalibration> of_bench,
                                                    std::span<const ChannelCalibration> of_devices,
                                                    std::chrono::year_month_day today);

/// Blocks a start. @throws BenchError naming every channel, its sensor and what to do, with its place in
/// the bench file where it has one; nothing where there is no trouble.
void RefuseToStart(std::span<const CalibrationTrouble> troubles, const BenchDescription& bench);

/// By the world's clock, UTC.
std::chrono::year_month_day Today();

/// New calibrations of sensors, by serial number, from a file (bench/campaign/README.md).
/// @throws BenchError with every finding.
std::vector<daq::acquisition::Calibration> ReadCalibrations(const std::filesystem::path& file);

/// Scales every column of a sensor in `calibrations` anew: back to the raw values by the calibration that
/// stands beside the column, forward by the new one. A column without one is raw as it stands.
/// @return the number of columns. @throws std::invalid_argument for a polynomial that cannot be gone back
///   through.
std::size_t Recalibrate(std::span<NamedRecord> records,
                        std::span<const daq::acquisition::Calibration> calibrations);

}  // namespace strainwave::bench
