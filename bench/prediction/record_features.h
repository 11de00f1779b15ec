// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/prediction/feature_settings.h"
#include "bench/records/record_reader.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Named values of one record: the features of every channel, in the order of the record's columns.
struct RecordFeatures {
  std::vector<std::string> names;
  std::vector<double> values;
};

/// The channel that `AddMotorTorque` makes.
inline constexpr const char* kMotorTorqueChannel = "motor_torque_Nm";

/// Adds the torque of the motor (which drives tell from its current) that was logged beside the vibration, at
/// the vibration's rate: linear between its samples. A record that has the channel, or a vibration whose
/// `rotation` logs none, stays as it is.
/// @param rotation  of kind motion, with `time_s` from the vibration's first sample on, and `torque_Nm`.
void AddMotorTorque(daq::Record& vibration, const daq::Record& rotation);

bool HasMotorTorque(const std::vector<std::string>& channels);

enum class MotorTorque { kAsRecorded, kAdded };
constexpr MotorTorque MotorTorqueAdded(bool added) {
  return added ? MotorTorque::kAdded : MotorTorque::kAsRecorded;
}

/// The records of kind vibration in a file. Records of other kinds beside them in one HDF5 file are passed
/// over, but that a measurement rotation beside the vibration tells its torque and temperature
/// (record_operating_point.h), and the motor's torque where it is to be added. What of the columns is no
/// channel (vibration_channels.h) stands in the notes.
/// @throws RecordError; BenchError if the file holds none.
std::vector<daq::Record> ReadVibrationRecords(const std::filesystem::path& path,
                                              MotorTorque motor_torque = MotorTorque::kAsRecorded,
                                              const RecordReader& reader = {});

/// The speed of the input shaft; none where the record tells none, or one that changes by more than a
/// hundredth.
std::optional<double> SteadyInputSpeedOf_rad_per_s(const daq::Record& record);

/// One channel's samples.
/// @param channel  its column; empty where the record has one channel alone.
/// @throws BenchError naming the channels that there are.
std::vector<double> ChannelOf(const daq::Record& record, const std::string& channel);

/// Samples a second, by the metadata `sample_rate_hz` or else by `time_s`.
/// @throws BenchError if there is neither, or the samples are not even in time.
double SampleRateOf_hz(const daq::Record& record);

/// Of the record as a whole, `CHANNEL.aLEVEL.COLUMN` or `CHANNEL.orders.LOW_HIGH` (feature_settings.h).
/// `features` keeps its memory between records.
/// @throws BenchError for energies by order if the record tells no speed of the input shaft, stands still,
///   changes speed by more than a hundredth, holds less than four turns, or is not evenly sampled.
RecordFeatures FeaturesOfRecord(const daq::Record& record, ChannelFeatures& features);

}  // namespace strainwave::bench
