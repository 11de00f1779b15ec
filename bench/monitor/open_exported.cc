// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/open_exported.h"

#include "bench/errors/bench_error.h"
#include "bench/fingerprint/exported_fingerprint.h"
#include "bench/prediction/exported_predictor.h"

namespace strainwave::bench {

std::unique_ptr<ExportedModel> OpenExported(const std::filesystem::path& folder,
                                            const std::filesystem::path& baseline) {
  if (IsExportedFingerprint(folder)) {
    if (!baseline.empty())
      Refuse("--baseline", "the model is of fingerprints of joints", "none: it is no predictor of changes");
    return std::make_unique<ExportedFingerprint>(folder);
  }
  auto predictor = std::make_unique<ExportedPredictor>(folder);
  predictor->UseBaseline(baseline);
  return predictor;
}

}  // namespace strainwave::bench
