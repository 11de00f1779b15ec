// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/bearing_orders.h"
#include "analysis/faults/fault_network.h"
#include "analysis/faults/fault_scores.h"
#include "bench/prediction/predictor_file.h"
#include "daq/record.h"

namespace strainwave::bench {

/// A model of faults: a predictor of classes (or, of several faults at once, of a value from 0 to 1 each),
/// and when it is to be believed.
struct FaultModel {
  Predictor predictor;
  bool labels{};  // several faults at once
  analysis::faults::FaultLine line{analysis::faults::FaultLine::kOurs};
  analysis::faults::UndecidedRule rule;
  Eigen::RowVectorXd thresholds;  // of labels
  std::optional<analysis::RollingBearing> bearing{};
  std::string report_json;  // an object: what `faults train --json` prints
};

/// Writes the predictor's folder and `faults.json`, last and sealed. @throws DataFileError.
void WriteFaultModel(const std::filesystem::path& folder, const FaultModel& model);

/// @throws BenchError if a file is missing, has changed since it was written, or does not fit the others.
FaultModel ReadFaultModel(const std::filesystem::path& folder);

/// What a part of a bearing should show, and does show, in the envelope of a record at a steady speed.
struct BearingSign {
  std::string part;  // "outer_race", "inner_race", "element", "cage"
  double order{};    // events a turn of the shaft
  double frequency_Hz{};
  double prominence_dB{};  // of its line over its neighbours, the strongest channel
};

/// What a model says of a record.
struct FaultVerdict {
  std::string file;
  std::string group;  // of HDF5; empty for CSV
  std::string name;   // the most probable class; of labels those present, joined by "+", or "none"
  std::vector<double> probability;  // one an output
  std::vector<bool> present;        // of labels
  bool undecided{};
  double distance{};  // above 1: outside what was trained on
  std::string why;    // undecided, in words
  std::vector<BearingSign> bearing;
};

/// @param speed_rpm  of the input shaft, where the record does not tell it.
/// @throws BenchError naming the record, and what of it is not as in training.
FaultVerdict Judge(const FaultModel& model, const daq::Record& record, std::optional<double> speed_rpm);

}  // namespace strainwave::bench
