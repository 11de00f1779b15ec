// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "bench/diagnosis/diagnosis_report.h"

namespace strainwave::bench {

/// Where the simulation may be trusted, as it is and with the causes found: "everywhere in these records", or
/// the ranges in which its error is more than the noise explains, the worst first.
std::string TrustWords(const DiagnosisReport& report, bool extended);

/// Every range of every regressor (docs/contract.md#diagnose), `trusted_regions` of the diagnosis.
nlohmann::ordered_json TrustJson(const DiagnosisReport& report);

/// Error over each regressor, beside the noise. @return its path, as RenderPicture does.
/// @throws GnuplotError, std::filesystem::filesystem_error as RenderPicture does.
std::filesystem::path DrawTrustedRegions(const DiagnosisReport& report, const std::filesystem::path& stem);

/// True where any regressor has ranges to draw.
bool HasTrustedRegions(const DiagnosisReport& report);

}  // namespace strainwave::bench
