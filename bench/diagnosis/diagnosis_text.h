// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/diagnosis/diagnosis_report.h"

namespace strainwave::bench {

/// A diagnosis for a technician: the verdict in a sentence, what was measured, every candidate with what
/// speaks for or against it, the gain, what remains, and what to do next.
std::string DiagnosisText(const DiagnosisReport& report);

/// The verdict alone: "One effect is missing in the simulation: backlash (in the unit)."
std::string VerdictSentence(const DiagnosisReport& report);

/// Where the files of a diagnosis are.
std::string FilesText(const std::filesystem::path& model, const std::vector<std::filesystem::path>& pictures);

}  // namespace strainwave::bench
