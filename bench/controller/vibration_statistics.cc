// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/vibration_statistics.h"

#include <string>
#include <utility>

namespace strainwave::bench {
namespace {

std::array<std::vector<float>*, 4> ChannelsOf(VibrationBlock& block) {
  return {&block.accel_x_m_per_s2, &block.accel_y_m_per_s2, &block.accel_z_m_per_s2,
          &block.accel_motor_z_m_per_s2};
}

}  // namespace

void VibrationStatistics::Start(Sampler& sampler, double sample_rate_hz) {
  sampler.StartVibration(sample_rate_hz);
  running_ = true;
}

void VibrationStatistics::Stop(Sampler& sampler) {
  sampler.StopVibration();
  running_ = false;
}

void VibrationStatistics::Take(Sampler& sampler) {
  if (!running_) return;
  sampler.DrainVibration(block_);
  const auto channels = ChannelsOf(block_);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    for (const float sample : *channels[i]) now_.of[i].Add(static_cast<double>(sample));
    channels[i]->clear();  // keeps its memory
  }
  now_.lost = block_.lost_samples;
  latest_.Set(now_);
}

daq::Record VibrationStatistics::Record(double sample_rate_hz) const {
  const VibrationMoments channels = latest_.Get();
  daq::Record record;
  record.kind = daq::RecordKind::kHistory;
  record.SetMetadata("statistics", "vibration");
  record.SetMetadata("sample_rate_hz", sample_rate_hz);
  record.SetMetadata("lost_samples", std::to_string(channels.lost));
  const auto add = [&](const std::string& name, double value) {
    record.columns.push_back({name, std::vector<double>{value}, {}, {}});
  };
  add("time_s", 0.0);
  for (std::size_t i = 0; i < kAccelerometers.size(); ++i) {
    const auto moments = channels.of[i].moments();
    if (moments.count == 0.0) continue;
    const std::string name = kAccelerometers[i];
    add(name + "_count", moments.count);
    add(name + "_mean_m_per_s2", moments.mean);
    add(name + "_second_moment_m2_per_s4", moments.second);
    add(name + "_third_moment_m3_per_s6", moments.third);
    add(name + "_fourth_moment_m4_per_s8", moments.fourth);
    add(name + "_least_m_per_s2", moments.least);
    add(name + "_most_m_per_s2", moments.most);
  }
  return record;
}

}  // namespace strainwave::bench
