// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <string>
#include <vector>

#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {

/// A result of the cycles: "k2_Nm_per_rad" is stem "k2", suffix "Nm_per_rad", unit "Nm/rad".
struct SeriesName {
  std::string full;
  std::string stem;
  std::string suffix;
  std::string unit;

  /// "step", "" → "step_k2_Nm_per_rad"; "trend", "per_1000h" → "trend_k2_Nm_per_rad_per_1000h".
  std::string Parameter(const std::string& what, const std::string& per) const;
};

/// The results of all cycles as one response without units: each series divided by its scatter from cycle to
/// cycle, and where series scatter together (K2 and K3 of one fit) mixed so that what is left is independent.
/// Series after series, in each the cycles that have a value.
struct CampaignLayout {
  std::vector<SeriesName> series;
  std::vector<double> scale;  // scatter of each series, in its unit
  std::vector<double> measured;
  std::vector<std::size_t> segments;
  std::vector<std::size_t> cycle_of;  // row of the campaign, one a sample
  std::vector<std::size_t> mixed_of;  // which mixture, one a sample
  Eigen::MatrixXd mixing;             // samples × series: response = mixing · values / scale
  double noise_floor{1.0};

  // By cycle:
  std::vector<double> cycle;
  std::vector<double> time_s;
  std::vector<double> load_time_s;
  std::vector<double> load_share;        // of the credited load time, 0 at the first cycle to 1 at the last
  std::vector<double> temperature_degC;  // empty where not measured in every cycle
  std::vector<std::string> sensor_serials;

  double load_span_s{};
  double run_in_share{};    // time constant of the run-in, as a share of the load time
  double single_tail{1.0};  // see CampaignNoise
  std::vector<std::string> warnings;

  std::size_t cycles() const { return cycle.size(); }
  double RowOfCycle(double number) const;  // fractional
  double CycleAtRow(double row) const;
  double LoadShareAt(double row) const;
};

/// Fewest cycles, and fewest values of a series, that can be diagnosed.
inline constexpr std::size_t kFewestCycles = 12;

/// @throws std::invalid_argument if columns differ in length, load time or time run backwards, or too few
///   cycles have values.
CampaignLayout LayOut(const CampaignData& campaign);

/// Columns of the wear model by cycle: constant, load time, its cube (what accelerates late in life), and the
/// run-in's exponential. In substance analysis/model/wear.h, whose course over one life it follows within the
/// error of a mean of 400 cycles.
Eigen::MatrixXd WearColumns(const std::vector<double>& load_share, double run_in_share);

}  // namespace strainwave::analysis::diagnosis
