// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "analysis/diagnosis/hysteresis/record.h"
#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// Name of a number that each record has one of: as it is for the first one, "NAME_2" for the second.
std::string OfRecord(const std::string& name, std::size_t record);

/// Stiffness (by the backbone) and width of every loop, as measured and as predicted; those that a loop does
/// not hold are left out.
std::vector<UserQuantity> QuantitiesOfLoops(const LoopRecords& records, const Eigen::VectorXd& predicted);

/// Whether several records have one stiffness, as the model that is fitted to all of them does: a sentence
/// with the two that differ most where they do not, by more than their errors and than 1 % of K2.
std::string DifferentStiffnesses(const LoopRecords& records);

}  // namespace strainwave::analysis::diagnosis
