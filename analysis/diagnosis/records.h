// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/simulated_null.h"
#include "analysis/diagnosis/study.h"
#include "analysis/parallel_for.h"

/// What the studies are made of: one struct a kind of record, in SI, and one function that makes the study of
/// several such records together. Optional columns are empty where the record has none.
namespace strainwave::analysis::diagnosis {

/// Angles as the record has them (not yet zeroed), in the order of the record.
struct TransmissionErrorData {
  std::vector<double> input_angle_rad;
  std::vector<double> output_angle_rad;
  std::vector<int> direction;  // +1 cw, −1 ccw
  std::vector<double> time_s;
  std::vector<double> torque_Nm;
  std::vector<double> temperature_degC;
  double ratio{80.0};
  bool absolute{};
};

struct HysteresisData {
  std::vector<double> time_s;
  std::vector<double> torque_Nm;
  std::vector<double> output_angle_rad;
  std::vector<double> temperature_degC;
  double t1_Nm{7.0};
  double t2_Nm{25.0};
  double t3_Nm{34.0};
};

/// An axis of any make. A linear one has metres and newtons in the same places.
struct MotionData {
  std::vector<double> time_s;
  std::vector<double> position;  // rad or m
  std::vector<double> torque;    // Nm or N
  std::vector<double> velocity;  // rad/s or m/s
  std::vector<double> temperature_degC;
  std::optional<double> inertia;  // kg m² or kg, where it is known
  bool linear{};
};

struct VibrationChannel {
  std::string name;  // "accel_x_m_per_s2"
  std::vector<double> values;
};

struct VibrationData {
  std::vector<VibrationChannel> channels;
  std::vector<double> time_s;  // always there: made from the rate where the record has only that
  std::vector<double> input_speed_rad_per_s;  // one a sample, or one value for the whole record, or empty
  std::vector<double> input_angle_rad;  // one a sample, or empty; counts for more than the speed; may start
                                        // anew each turn
  double ratio{80.0};

  bool KnowsSpeedOfSamples() const { return !input_angle_rad.empty() || input_speed_rad_per_s.size() > 1; }
};

/// Results of a campaign, one row a cycle; NaN where a cycle has no value.
struct CampaignSeries {
  std::string name;  // "k2_Nm_per_rad"
  std::vector<double> value;
  std::vector<double> standard_error;
};
struct CampaignData {
  std::vector<double> cycle;
  std::vector<double> time_s;               // wall time of the measurement
  std::vector<double> load_time_s;          // credited so far
  std::vector<double> temperature_degC;     // at the measurement
  std::vector<std::string> sensor_serials;  // one a cycle: all serial numbers that stamped it, joined
  std::vector<CampaignSeries> series;
};

/// @throws std::invalid_argument in words for a technician where the records cannot be diagnosed at all (too
///   short to hold anything out, constant position, saturated torque): what was seen, what was expected.
std::unique_ptr<Study> MakeTransmissionErrorStudy(std::span<const TransmissionErrorData> records);
std::unique_ptr<Study> MakeHysteresisStudy(std::span<const HysteresisData> records);
std::unique_ptr<Study> MakeMotionStudy(std::span<const MotionData> records);
/// Such records of axes without any named effect (DiagnoseOptions::simulate).
SimulateNull SimulateMotion(std::vector<MotionData> records);
std::unique_ptr<Study> MakeVibrationStudy(std::span<const VibrationData> records);
/// @param parallel  over parts of one search
std::unique_ptr<Study> MakeVibrationStudy(std::span<const VibrationData> records, ParallelFor parallel);
std::unique_ptr<Study> MakeCampaignStudy(const CampaignData& campaign);

}  // namespace strainwave::analysis::diagnosis
