// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "bench/diagnosis/diagnosis_report.h"

namespace strainwave::bench {

/// The pictures of a diagnosis, each as SVG and PNG: `measured_over_simulated`, `residual`,
/// `residual_over_REGRESSOR` for each regressor, `order_spectrum`, `candidates`, and `detection_power`
/// where it was measured. Long records are thinned
/// for drawing; means and spectra are those of all samples. Those of a campaign have a panel for each result,
/// in its unit, and no spectrum.
///
/// @param progress  called with the share done; may be empty.
/// @return the pictures' paths without ending, those that tell most first.
/// @throws GnuplotError, std::filesystem::filesystem_error as RenderPicture does.
std::vector<std::filesystem::path> DrawDiagnosis(const DiagnosisReport& report,
                                                 const std::filesystem::path& folder,
                                                 const std::function<void(double)>& progress = {});

/// One picture of those above. @return its path, as RenderPicture does.
std::filesystem::path DrawResponse(const DiagnosisReport& report, const std::filesystem::path& stem);
std::filesystem::path DrawResidual(const DiagnosisReport& report, const std::filesystem::path& stem);
std::filesystem::path DrawResidualOver(const DiagnosisReport& report, std::size_t regressor,
                                       const std::filesystem::path& stem);
std::filesystem::path DrawResidualSpectrum(const DiagnosisReport& report, const std::filesystem::path& stem);
std::filesystem::path DrawCampaignResults(const DiagnosisReport& report, const std::filesystem::path& stem);
std::filesystem::path DrawCampaignResiduals(const DiagnosisReport& report, std::size_t regressor,
                                            const std::filesystem::path& stem);
std::filesystem::path DrawCandidates(const DiagnosisReport& report, const std::filesystem::path& stem);

}  // namespace strainwave::bench
