// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/diagnosis/diagnosis_report.h"

namespace strainwave::bench {

/// A diagnosis for a technician: what is missing, how sure that is and what to do in
/// plain words, the verdict in a sentence, what was
/// measured, what was found with the largest first and the simulation's numbers corrected by it, every
/// candidate with what speaks for or against it, the gain, what remains, and what to do next.
/// @param details  with the numbers of every line and channel (IsDetail).
std::string DiagnosisText(const DiagnosisReport& report, bool details);

/// The verdict alone: "One effect is missing in the simulation: backlash (in the unit)."
std::string VerdictSentence(const DiagnosisReport& report);

/// Where the files of a diagnosis are.
std::string FilesText(const std::filesystem::path& model, const std::vector<std::filesystem::path>& pictures);

}  // namespace strainwave::bench
