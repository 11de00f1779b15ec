// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/features/wavelet_features.h"

namespace strainwave::bench {

/// The wavelet features of the measurement rotations of a campaign, a row a cycle.
struct CampaignFeatures {
  std::vector<std::string> channels;         // of the vibration record
  std::vector<std::string> torque_channels;  // of the rotation record; may be none
  std::vector<std::string> names;            // all of vibration, then all of torque
  std::vector<int> cycle;
  Eigen::MatrixXd values;   // cycles × names
  double sample_rate_hz{};  // of the vibration
  std::size_t least_samples{};
  std::vector<std::string> notes;  // cycles that were left out, and why
};

/// Told how many of how many cycles are done.
using FeatureProgress = std::function<void(std::size_t done, std::size_t all)>;

/// Computes the features of all complete cycles and keeps them in the folder as `features.h5` (a data set a
/// feature, `CHANNEL.aLEVEL.COLUMN`, beside `cycle`); what is there already, of the same recipe, is not
/// computed again. A cycle without a vibration record, or with other channels or another rate than the first
/// one has, is left out with a note.
/// @throws CampaignError if the folder is no campaign or no cycle has vibration.
CampaignFeatures FeaturesOfCampaign(const std::filesystem::path& folder,
                                    const analysis::features::WaveletRecipe& recipe,
                                    const FeatureProgress& progress);

}  // namespace strainwave::bench
