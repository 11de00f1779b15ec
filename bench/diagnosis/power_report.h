// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/diagnosis/diagnosis_report.h"

namespace strainwave::bench {

/// How large each cause has to be in these records to be found nine times of ten: plain words first, then the
/// sizes with their intervals, in the cause's unit and in standard errors, how often the planted effects were
/// found and what else was named; at last what cannot be found here, and why. Empty where it was not
/// measured.
/// @param duration  that the measurement took, "41 s"
std::string PowerText(const DiagnosisReport& report, const std::string& duration);

/// The same with every trial (docs/contract.md#diagnose), `power` of the diagnosis.
nlohmann::ordered_json PowerJson(const DiagnosisReport& report);

/// Causes of the kind (docs/contract.md) that these records do not show at any size.
std::vector<std::string> CausesNotShown(const DiagnosisReport& report);

/// The sizes as bars. @return its path, as RenderPicture does.
/// @throws GnuplotError, std::filesystem::filesystem_error as RenderPicture does.
std::filesystem::path DrawDetectionPower(const DiagnosisReport& report, const std::filesystem::path& stem);

}  // namespace strainwave::bench
