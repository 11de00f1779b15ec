// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analysis/features/wavelet_features.h"
#include "analysis/prediction/samples.h"

namespace strainwave::bench {

/// A campaign that was trained on.
struct TrainingSource {
  std::string folder;
  std::string specimen;
  std::size_t records{};
};

/// Vibration features and measured results of campaigns, side by side.
struct TrainingData {
  analysis::prediction::Samples samples;  // features of vibration first, then of torque
  std::size_t vibration_features{};
  std::vector<std::string> channels;
  double sample_rate_hz{};
  std::size_t least_samples{};
  std::vector<TrainingSource> sources;
  std::vector<std::string> notes;  // what was left out, and why
  std::string sha256;              // of all features and targets that were used
};

/// The quantities a predictor is trained on unless told otherwise, all that the campaigns have of these.
inline constexpr const char* kPredictedQuantities[] = {"e_max_arcmin", "e_avg_arcmin", "k1_Nm_per_rad",
                                                       "k2_Nm_per_rad", "k3_Nm_per_rad"};

/// Reads campaign folders; two folders of one specimen are one reducer. Cycles with a flagged result, and
/// features that are not finite in every cycle, are left out with a note.
/// @param outputs  results of the journal by name.
/// @throws CampaignError if a folder is no campaign, they have different channels or rates, an output is in
///   none of them or is constant, or fewer than 20 cycles are left.
TrainingData ReadTrainingData(const std::vector<std::filesystem::path>& folders,
                              const analysis::features::WaveletRecipe& recipe,
                              const std::vector<std::string>& outputs,
                              const std::function<void(const std::string& step, double share)>& progress);

}  // namespace strainwave::bench
