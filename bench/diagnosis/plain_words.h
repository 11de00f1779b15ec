// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/diagnosis/diagnosis_report.h"

namespace strainwave::bench {

/// A diagnosis in three sentences without a name of the program's own, for who reads no more.
struct PlainWords {
  std::string what_is_missing;  // empty where no cause was found
  std::string how_sure;
  std::string what_to_do;
};

/// Of the cause that explains most: "an error once per turn of the output (88 % of what the simulation
/// misses, and one smaller effect)", "chance shows as much in fewer than one of 10 000 such records; on data
/// that no fit has seen the error falls by 63 %", and the next step.
PlainWords PlainWordsOf(const DiagnosisReport& report);

/// Those of the list by what they explain, largest first.
std::vector<const analysis::diagnosis::Finding*> LargestFirst(
    const std::vector<analysis::diagnosis::Finding>& findings);

}  // namespace strainwave::bench
