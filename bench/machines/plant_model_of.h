// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/model/plant_model.h"
#include "bench/configuration/bench_description.h"

namespace strainwave::bench {

/// The nominal plant with what the bench file says differently.
/// @throws BenchFileError for a term or a parameter that there is not.
analysis::model::PlantModel PlantModelOf(const BenchDescription& description, double ratio);

}  // namespace strainwave::bench
