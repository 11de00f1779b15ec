// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/sample_alignment.h"

#include <algorithm>
#include <cmath>

#include "bench/controller/seconds.h"

namespace strainwave::bench {

template <typename Sample>
void SampleAlignment::History<Sample>::Push(const Sample& sample) noexcept {
  if (count > 0 && sample.time <= Newest().time) return;
  samples[count++ % samples.size()] = sample;
}

template <typename Sample>
typename SampleAlignment::History<Sample>::Between SampleAlignment::History<Sample>::At(
    std::chrono::nanoseconds time) const noexcept {
  const std::size_t kept = std::min(count, samples.size());
  std::size_t back = 0;
  while (back + 1 < kept && Newest(back).time > time) ++back;
  const Sample& before = Newest(back);
  if (back == 0 || before.time >= time) return {before, before, 0.0};
  const Sample& after = Newest(back - 1);
  return {before, after, Seconds(time - before.time) / Seconds(after.time - before.time)};
}

std::optional<AlignedSample> SampleAlignment::Step(const Readings& readings) noexcept {
  torque_.Push({readings.torque_time, readings.output_torque_Nm});
  angles_.Push({readings.angles_time, readings.input_angle_rad, readings.output_angle_rad});
  const std::chrono::nanoseconds time = std::min(torque_.Newest().time, angles_.Newest().time);
  if (answered_ && time <= *answered_) return std::nullopt;
  answered_ = time;
  const auto torque = torque_.At(time);
  const auto angles = angles_.At(time);
  return AlignedSample{
      time, std::lerp(torque.before.output_torque_Nm, torque.after.output_torque_Nm, torque.share),
      std::lerp(angles.before.input_angle_rad, angles.after.input_angle_rad, angles.share),
      std::lerp(angles.before.output_angle_rad, angles.after.output_angle_rad, angles.share)};
}

}  // namespace strainwave::bench
