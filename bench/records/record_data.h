// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/diagnosis/records.h"
#include "daq/record.h"

/// Records in field units as the structs in SI that studies are made of.
namespace strainwave::bench {

analysis::diagnosis::TransmissionErrorData TransmissionErrorDataOf(const daq::Record& record);
analysis::diagnosis::HysteresisData HysteresisDataOf(const daq::Record& record);
/// A current in the torque's place is multiplied by its gain.
analysis::diagnosis::MotionData MotionDataOf(const daq::Record& record);
/// The channels are those of `VibrationChannelsOf`.
analysis::diagnosis::VibrationData VibrationDataOf(const daq::Record& record);

/// Of a vibration record: a value a sample, one in all from the metadata, or none.
std::vector<double> InputSpeedsOf_rad_per_s(const daq::Record& record);

/// Of a vibration record: the angle of the input shaft, a value a sample, or none.
std::vector<double> InputAnglesOf_rad(const daq::Record& record);

/// The columns that are channels of a vibration record, in its order (vibration_channels.h).
/// @throws BenchError naming the record if none is.
std::vector<std::string> VibrationChannelsOf(const daq::Record& record);

}  // namespace strainwave::bench
