// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/sample_alignment.h"

#include <algorithm>
#include <cmath>

#include "bench/seconds.h"

namespace strainwave::bench {

void SampleAlignment::History::Push(const Sample& sample) noexcept {
  if (count_ > 0 && sample.time <= Newest().time) return;
  samples_[count_++ % samples_.size()] = sample;
}

std::size_t SampleAlignment::History::kept() const noexcept { return std::min(count_, samples_.size()); }

std::size_t SampleAlignment::History::BackTo(std::chrono::nanoseconds time) const noexcept {
  std::size_t back = 0;
  while (back + 1 < kept() && Newest(back).time > time) ++back;
  return back;
}

double SampleAlignment::History::At(std::chrono::nanoseconds time) const noexcept {
  const std::size_t back = BackTo(time);
  const Sample& before = Newest(back);
  if (back == 0 || before.time >= time) return before.value;
  const Sample& after = Newest(back - 1);
  return std::lerp(before.value, after.value,
                   Seconds(time - before.time) / Seconds(after.time - before.time));
}

void SampleAlignment::Push(const Readings& readings) noexcept {
  input_angle_.Push({readings.input_angle_time, readings.input_angle_rad});
  output_angle_.Push({readings.output_angle_time, readings.output_angle_rad});
  input_speed_.Push({readings.input_speed_time, readings.input_speed_rad_per_s});
  output_torque_.Push({readings.torque_time, readings.output_torque_Nm});
  motor_torque_.Push({readings.motor_torque_time, readings.motor_torque_Nm});
}

std::optional<AlignedSample> SampleAlignment::Next() noexcept {
  const std::chrono::nanoseconds known_from =
      std::max(input_angle_.Oldest().time, output_torque_.Oldest().time);
  const std::chrono::nanoseconds known_to =
      std::min(input_angle_.Newest().time, output_torque_.Newest().time);
  // Of the output's samples that have not been answered, the oldest.
  const auto is_open = [&](const Sample& sample) {
    return sample.time > answered_ && sample.time >= known_from;
  };
  std::size_t back = 0;
  while (back < output_angle_.kept() && is_open(output_angle_.Newest(back))) ++back;
  if (back == 0) return std::nullopt;
  const Sample& output = output_angle_.Newest(back - 1);
  if (output.time > known_to) return std::nullopt;
  const bool has_new_torque = output_torque_.Newest(output_torque_.BackTo(output.time)).time > answered_;
  answered_ = output.time;
  return AlignedSample{output.time,
                       input_angle_.At(output.time),
                       output.value,
                       input_speed_.At(output.time),
                       output_torque_.At(output.time),
                       motor_torque_.At(output.time),
                       has_new_torque};
}

}  // namespace strainwave::bench
