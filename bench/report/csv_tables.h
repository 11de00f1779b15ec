// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "bench/report/document.h"

namespace strainwave::bench {

/// The named tables of a document, one file each, and cycles.csv of each campaign; the folder is made where
/// it is missing, files of these names are replaced. Of several campaigns all names but the first section's
/// begin with the campaign's number, from 1: "2_cycles.csv".
/// @return how many files were written. @throws DataFileError, std::filesystem::filesystem_error.
int WriteCsvTables(const ReportDocument& document, std::span<const CampaignSheet> sheets,
                   const std::filesystem::path& folder);

}  // namespace strainwave::bench
