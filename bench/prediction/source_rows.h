// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "bench/prediction/feature_settings.h"
#include "bench/prediction/operating_envelope.h"
#include "bench/prediction/record_windows.h"
#include "bench/records/record_reader.h"
#include "bench/records/record_warnings.h"

namespace strainwave::bench {

/// What a predictor is trained on where none of analysis::kPredictedQuantities was measured.
inline constexpr const char* kClassLabel = "class";

/// What is asked of the sources.
struct SourceSettings {
  FeatureSettings features;
  std::vector<std::string> outputs;   // by name; `class` alone for classes; empty: all measured of the
                                      // predicted quantities, or else the class
  std::vector<std::string> channels;  // empty: those of the first source
  double sample_rate_hz{};         // to which whole multiples are brought down; 0: that of the first source
  std::optional<double> window_s;  // of records; 0: whole; none: by how many records there are
  bool motor_torque{};             // the motor's torque of a measurement rotation as a channel
  RecordReader reader{};           // of record files
};

/// What vibration is taken of, the same in all sources.
struct SourceShape {
  std::vector<std::string> channels;
  std::vector<std::string> names;  // of features: of vibration, then of torque
  std::size_t vibration_features{};
  double sample_rate_hz{};
};

/// Rows to learn from, of one campaign or one record file: features of a segment of vibration, and what was
/// measured with it.
struct SourceRows {
  std::filesystem::path source;
  std::string specimen;  // empty where nothing names it
  SourceShape shape;
  std::size_t least_samples{};
  OperatingEnvelope operating{};
  std::vector<double> place;  // of each row in the specimen's life: the cycle, or the number of the window
  std::vector<Eigen::RowVectorXd> features;
  std::vector<std::vector<double>> targets;  // a value an output; empty for classes
  std::vector<std::string> classes;          // empty for values
  std::vector<std::string> notes;            // what was left out, and why
};

/// Told how many of how many are done.
using SourceProgress = std::function<void(std::size_t done, std::size_t all)>;

/// The results of the predicted quantities that a campaign has. @throws BenchError.
std::vector<std::string> CampaignOutputs(const std::filesystem::path& folder);

/// A row a cycle. @throws BenchError as `FeaturesOfCampaign`.
SourceRows ReadCampaignRows(const std::filesystem::path& folder, const SourceSettings& settings,
                            const std::vector<std::string>& outputs, const SourceProgress& progress);

/// What the records of some files have in common, found before any feature is computed.
struct RecordFiles {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> outputs;  // found, or asked for
  SignalSettings signals;
  WindowLength window;
  std::vector<RecordWarning> warnings{};  // of all records
};

/// Looks at all records: outputs, channels, rate, and how to cut them. Records are cut where there are fewer
/// than 200: into so many windows that there are about 400 in all, none shorter than 2048 samples or eight
/// turns of the input shaft, in whole turns where every record tells a steady speed.
/// @throws BenchError if no record has a label, or rates or channels differ, naming the record.
RecordFiles SurveyRecords(const std::vector<std::filesystem::path>& files, const SourceSettings& settings);

/// A row a window. Records that lack a label, are too short or whose sensors
/// are dead or clipped are left out with a note.
std::vector<SourceRows> ReadRecordRows(const RecordFiles& records, const SourceSettings& settings,
                                       const SourceProgress& progress);

}  // namespace strainwave::bench
