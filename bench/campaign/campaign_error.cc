// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/campaign_error.h"

#include <fmt/format.h>

namespace strainwave::bench {

void Refuse(const std::filesystem::path& where, const std::string& what, const std::string& expected) {
  throw CampaignError(ExitCode::kWrongInput,
                      fmt::format("{}: error: {} (expected {})", where.string(), what, expected));
}

}  // namespace strainwave::bench
