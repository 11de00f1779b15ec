// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/diagnosis/records.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// The results of every complete cycle, what of the bench may have changed them, and who measured: serial
/// numbers as the raw records carry them. Results with a flag are left out, but for those that only were not
/// measured in the declared thermal state: their temperature is known.
analysis::diagnosis::CampaignData CampaignDataOf(const CampaignFolder& folder, const Journal& journal);

}  // namespace strainwave::bench
