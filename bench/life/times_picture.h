// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "bench/life/times_report.h"

namespace strainwave::bench {

/// The share that has failed over time on Weibull paper, where a law is a line: of each failure at its median
/// rank among all (Benard; Johnson's adjusted ranks with suspensions), and the fitted law with its bounds.
/// Nothing where there is no law of two parameters to draw. @throws GnuplotError as RenderPicture does.
std::optional<std::filesystem::path> DrawTimes(const TimesReport& report, const std::filesystem::path& stem);

}  // namespace strainwave::bench
