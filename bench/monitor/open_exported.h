// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "bench/prediction/exported_model.h"

namespace strainwave::bench {

/// A folder that `export` or `fingerprint export` wrote, tested.
/// @param baseline  what the reducer was like at first, for a predictor of changes; else empty.
/// @throws BenchError naming the file, what is wrong with it and what was expected.
std::unique_ptr<ExportedModel> OpenExported(const std::filesystem::path& folder,
                                            const std::filesystem::path& baseline);

}  // namespace strainwave::bench
