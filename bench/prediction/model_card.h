// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/prediction/predictor_file.h"

namespace strainwave::bench {

/// What a predictor is, from what it was trained and how well it did, for people and for programs.
struct ModelCard {
  std::string markdown;
  std::string json;
};
/// @param exported_utc  "2026-03-01T12:00:00.250Z".
ModelCard ModelCardOf(const Predictor& predictor, const std::string& exported_utc);

}  // namespace strainwave::bench
