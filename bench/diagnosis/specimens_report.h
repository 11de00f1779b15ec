// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/diagnosis/between_specimens.h"
#include "bench/diagnosis/diagnosis_report.h"

namespace strainwave::bench {

/// One specimen's own diagnosis.
struct DiagnosedSpecimenReport {
  std::string name;
  std::string folder;  // of its files, below that of all
  DiagnosisReport report;
};

/// Several specimens, and what they share.
struct SpecimensReport {
  std::vector<DiagnosedSpecimenReport> specimens;                    // two or more
  std::vector<analysis::diagnosis::SpecimenComparison> comparisons;  // sizes in the order of the specimens
};

/// True where the phases of records of several specimens have one zero: that of the bench's encoders. Those
/// of a vibration count from where its record begins.
bool PhasesHaveOneZero(StudyKind kind);

/// "shared", "own" or "undecided".
std::string BelongingText(analysis::diagnosis::Belonging belonging);

/// Why: "comes with the bench: all 4 specimens have it, and they differ by at most 0.021 arcmin where the
/// mean is 0.301 arcmin".
std::string BelongingSentence(const SpecimensReport& report,
                              const analysis::diagnosis::SpecimenComparison& comparison);

/// For a technician: how many effects belong where, what each specimen's own diagnosis says, and for each
/// cause its size in every specimen, the mean, the spread and the verdict.
std::string SpecimensText(const SpecimensReport& report);

/// As `diagnose --by-specimen --json` prints it (docs/contract.md#several-specimens).
nlohmann::ordered_json SpecimensJson(const SpecimensReport& report);

/// A panel a cause: its size in each specimen with its 95 % interval, and the mean with a band of one
/// standard deviation between specimens; of a vector what lies along the mean's phase and across it.
/// @return its path, as RenderPicture does.
/// @throws GnuplotError, std::filesystem::filesystem_error as RenderPicture does.
std::filesystem::path DrawSpecimens(const SpecimensReport& report, const std::filesystem::path& stem);

/// True where there is a cause whose size is known in two specimens.
bool HasSpecimensPicture(const SpecimensReport& report);

}  // namespace strainwave::bench
