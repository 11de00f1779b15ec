// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "bench/realtime/latest.h"
#include "bench/roles/sampler.h"
#include "daq/acquisition/running_statistics.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Of every accelerometer, in the order of VibrationBlock.
struct VibrationMoments {
  std::array<daq::acquisition::RunningStatistics, 4> of{};
  std::uint64_t lost{};
};

/// Statistics of the accelerometers over a phase as the samples pass, none of them kept. One thread takes
/// samples; others may ask for the record so far.
class VibrationStatistics {
 public:
  void Start(Sampler& sampler, double sample_rate_hz);
  void Stop(Sampler& sampler);
  bool running() const { return running_; }
  /// What came in since the last call; nothing while it does not run.
  void Take(Sampler& sampler);

  /// One row of moments, from which segments of a run can be put together again (`bench/campaign`).
  daq::Record Record(double sample_rate_hz) const;

 private:
  bool running_{};
  VibrationBlock block_;
  VibrationMoments now_;
  Latest<VibrationMoments> latest_;
};

}  // namespace strainwave::bench
