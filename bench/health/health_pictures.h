// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/health/what_if.h"
#include "bench/health/train_health.h"

namespace strainwave::bench {

/// What was learnt from, after docs/sources.md#lee-2023, figs. 7 to 10: signals, spectra, coefficients and
/// energies of bands in some conditions. Stems of the pictures.
/// @throws GnuplotError.
std::vector<std::filesystem::path> DrawHealthData(const HealthData& data,
                                                  const std::filesystem::path& folder);

/// What was learnt, after figs. 11 to 15: selection, best and worst feature, principal components of the best
/// and worst four (in place of the source's t-SNE), errors of each split, the system's surface.
std::vector<std::filesystem::path> DrawHealthTraining(const HealthData& data, const HealthOutcome& outcome,
                                                      const std::filesystem::path& folder);

/// After fig. 16: state, shares, and the states after each replacement.
std::filesystem::path DrawWhatIf(const std::vector<std::string>& components, const Eigen::VectorXd& state,
                                 const analysis::health::WhatIf& answer, const std::filesystem::path& stem);

}  // namespace strainwave::bench
