// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {

/// What a hysteresis fit is made on: samples, or means of a few neighbouring ones; several records one after
/// the other.
struct LoopGrid {
  std::vector<double> time_s;        // each record from its own start
  std::vector<double> torque_Nm;     // what drives the model
  std::vector<double> twist_rad;     // measured, each record about its own centre
  std::vector<double> position_rad;  // of the output on its path; of PrepareLoopRecords with its noise
  std::vector<double> weight;
  std::vector<double> temperature_K;  // from the mean of all; empty where no record has it or it stands still
  std::vector<double> direction;      // +1 on rising branches of the torque, −1 on falling
  /// Torque at which the way from the point before turned, and its share of the time between; NaN where it
  /// did not.
  std::vector<double> turn_Nm;
  std::vector<double> turn_share;
  /// Rate of the torque on the way from the point before, behind a turn on it, without the torque's noise.
  std::vector<double> rate_Nm_per_s;
  std::vector<std::size_t> starts;  // of the records, and behind them the number of points

  std::size_t size() const { return torque_Nm.size(); }
  std::size_t records() const { return starts.size() - 1; }
};

/// Hysteresis records made ready to be diagnosed together.
struct LoopRecords {
  std::vector<double> measured_rad;  // as the records have it
  std::vector<double> measured_torque_Nm;
  std::vector<double> torque_noise_Nm;  // taken off the torque that drives the model
  std::vector<double> torque_rate_Nm_per_s;
  LoopGrid samples;
  std::vector<double> centre_rad;     // of each record: the angle that its twist counts from
  std::vector<std::size_t> branches;  // first sample of each branch of the torque, and the number of samples
  double t1_Nm{};
  double t2_Nm{};
  double t3_Nm{};
  double peak_torque_Nm{};   // largest size of the torque
  double twist_range_rad{};  // largest of a record
  double duration_s{};       // of the longest record
  double step_s{};           // median between samples
  double noise_floor_rad{};
  double rounding_rad{};        // standard deviation by the steps of angle and torque; 0: there are none
  double position_noise_rad{};  // of the angle, from sample to sample
  std::size_t block_length{};
  std::vector<std::string> warnings;

  /// Branches of the torque, of one record: a loop is two of them.
  double passes() const {
    return static_cast<double>(branches.size() - 1) / static_cast<double>(samples.records());
  }
  double compliance_rad_per_Nm() const { return 0.5 * twist_range_rad / peak_torque_Nm; }
};

/// Checks the records and makes them ready: torque without the noise that the gear does not follow, single
/// torque spikes bridged, torque turned where the twist falls with it (with a warning).
/// @throws std::invalid_argument in words for a technician: what was seen, what was expected.
LoopRecords PrepareLoopRecords(std::span<const HysteresisData> records);

/// Points that are means of as many neighbouring samples as it takes to have about `most` of them, weighted;
/// reversals of the torque stay points of their own, so that the model's history is the same. With `most` 0,
/// or at least the number of samples, the samples themselves with these weights.
LoopGrid Condense(const LoopRecords& records, std::span<const double> weights, std::size_t most);

}  // namespace strainwave::analysis::diagnosis
