// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>

#include "bench/roles/sampler.h"

namespace strainwave::bench {

/// Angles, speed and torques of one moment.
struct AlignedSample {
  std::chrono::nanoseconds time{};  // of a sample of the output angle
  double input_angle_rad{};
  double output_angle_rad{};
  double input_speed_rad_per_s{};
  double output_torque_Nm{};
  double motor_torque_Nm{};
  bool has_new_torque{};  // the output torque was sampled since the moment before
};

/// Brings what the devices of a bench have sampled at moments of their own to the moments of the output
/// angle, by straight lines between two samples:
///
///   x(t) = x₁ + (x₂ − x₁) (t − t₁) / (t₂ − t₁),  t₁ ≤ t ≤ t₂.
///
/// Newest values beside each other would be of different moments: of a torque amplifier that is 10 ms late a
/// loop at 3 Nm/s gets wider by 0.06 Nm, 3 % of the friction of a small gear; an encoder that is 10 ms late
/// moves the transmission error at 1000 rpm of the input by 45 arcmin (docs/effects.md E20).
///
/// The output angle is taken as it was sampled, since it carries the transmission error, whose harmonics a
/// straight line would cut off. The input is nearly steady: its angle is off by a h² / 8 at an acceleration a
/// and samples h apart, at the output by the ratio less. A moment is answered once both angles and the output
/// torque are known on both sides of it, so that the latest of the three delays the answer and nothing else.
/// Input speed and motor torque, which change little while a measurement lasts, delay nothing: before
/// their next sample is there the newest one stands for it.
///
/// Keeps the last 256 samples of each: of moments that lie further back nothing is answered.
class SampleAlignment {
 public:
  /// Of the moments up to this one nothing is answered any more.
  void BeginAfter(std::chrono::nanoseconds time) noexcept { answered_ = time; }
  /// Once a control period.
  void Push(const Readings& readings) noexcept;
  /// The oldest moment that has not been answered yet; none until a later one is known. Once something has
  /// been pushed.
  std::optional<AlignedSample> Next() noexcept;

 private:
  struct Sample {
    std::chrono::nanoseconds time{};
    double value{};
  };
  /// The newest samples of one channel; the oldest gives way.
  class History {
   public:
    /// Nothing where it is not newer than the newest.
    void Push(const Sample& sample) noexcept;
    std::size_t kept() const noexcept;
    const Sample& Newest(std::size_t back = 0) const noexcept {
      return samples_[(count_ - 1 - back) % samples_.size()];
    }
    const Sample& Oldest() const noexcept { return Newest(kept() - 1); }
    /// How far back the newest sample of not after `time` lies; that of the oldest where all are after it.
    std::size_t BackTo(std::chrono::nanoseconds time) const noexcept;
    double At(std::chrono::nanoseconds time) const noexcept;

   private:
    std::array<Sample, 256> samples_{};
    std::size_t count_{};
  };

  History input_angle_;
  History output_angle_;
  History input_speed_;
  History output_torque_;
  History motor_torque_;
  std::chrono::nanoseconds answered_{std::chrono::nanoseconds::min()};
};

}  // namespace strainwave::bench
