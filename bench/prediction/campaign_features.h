// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "bench/prediction/feature_settings.h"
#include "bench/prediction/operating_envelope.h"

namespace strainwave::bench {

/// The features of the measurement rotations of a campaign, a row a cycle.
struct CampaignFeatures {
  std::vector<std::string> channels;         // of the vibration record
  std::vector<std::string> torque_channels;  // of the rotation record; may be none
  std::vector<std::string> names;            // all of vibration, then all of torque
  std::vector<int> cycle;
  Eigen::MatrixXd values;   // cycles × names
  double sample_rate_hz{};  // of the vibration
  std::size_t least_samples{};
  OperatingEnvelope operating;     // of these cycles
  std::vector<std::string> notes;  // cycles that were left out, and why
  std::string not_kept;            // why they are in no file; empty as a rule
};

/// Told how many of how many cycles are done.
using FeatureProgress = std::function<void(std::size_t done, std::size_t all)>;

/// Computes the features of all complete cycles and keeps them in the folder as `features.h5`, those by order
/// as `features_orders.h5` (a data set a feature, beside `cycle`); what is there already, of the same
/// settings, is not computed again. Where nothing can be written they are in no file. A cycle without a
/// vibration record, or with other channels or another rate than the first one has, is left out with a note.
/// @param motor_torque  the motor's torque of the rotation as a channel beside the vibration's.
/// @throws BenchError if the folder is no campaign or no cycle has vibration.
CampaignFeatures FeaturesOfCampaign(const std::filesystem::path& folder, const FeatureSettings& settings,
                                    bool motor_torque, const FeatureProgress& progress);

/// Where they are kept.
std::filesystem::path FeaturesFile(const std::filesystem::path& folder, FeatureSet set);

}  // namespace strainwave::bench
