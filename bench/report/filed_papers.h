// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/report/document.h"

namespace strainwave::bench {

/// What other commands have written about a campaign's gear or bench.
struct FiledPapers {
  std::vector<std::filesystem::path> diagnoses;   // diagnosis.json, or what `diagnose --json` prints
  std::vector<std::filesystem::path> predictors;  // folders of `train` or `export`
  std::vector<std::filesystem::path> trip_tests;  // sheets of `bench trip-test --out`
};

/// Those that lie in a campaign's folder: diagnosis/diagnosis.json, predictor/, trip_test.json.
FiledPapers PapersIn(const std::filesystem::path& campaign);

/// A section each: trip tests, diagnoses, predictors; of a kind that there is none of, a sentence. From the
/// second of a kind on, titles and names of tables end in its number.
/// @throws BenchError for a paper that cannot be read or is of another kind, naming it and what was expected.
std::vector<ReportSection> FiledSections(const FiledPapers& papers);

/// The sections by themselves. @throws as FiledSections.
ReportSection DiagnosisSection(const std::filesystem::path& file);
ReportSection PredictorSection(const std::filesystem::path& folder);
ReportSection TripTestSection(const std::filesystem::path& file);

/// Reads JSON and makes a section of it: "is no JSON", or "is no `what`" where `make` finds it to be
/// something else (nlohmann's exceptions).
/// @throws BenchError.
ReportSection SectionOfJson(const std::filesystem::path& file, const std::string& text,
                            const std::string& what, const std::string& expected,
                            const std::function<ReportSection(const nlohmann::ordered_json&)>& make);

}  // namespace strainwave::bench
