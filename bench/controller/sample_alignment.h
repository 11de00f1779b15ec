// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>

#include "bench/roles/sampler.h"

namespace strainwave::bench {

/// Torque and angles of one moment. Each comes with the time of its own sample: a torque amplifier that is
/// 10 ms late widens a loop at 3 Nm/s by 0.06 Nm, 3 % of the friction of a small gear, if its newest value is
/// put beside the newest angle.
struct AlignedSample {
  std::chrono::nanoseconds time{};  // of the older of the two newest samples
  double output_torque_Nm{};
  double input_angle_rad{};
  double output_angle_rad{};
};

/// Brings both to the time of the older one, by straight lines between samples. Keeps the last 32 of each:
/// what is later than these are long counts as the oldest of them.
class SampleAlignment {
 public:
  /// Once a control period. None until both have a sample that is newer than the last answer's time.
  std::optional<AlignedSample> Step(const Readings& readings) noexcept;

 private:
  struct Torque {
    std::chrono::nanoseconds time{};
    double output_torque_Nm{};
  };
  struct Angles {
    std::chrono::nanoseconds time{};
    double input_angle_rad{};
    double output_angle_rad{};
  };
  /// The newest samples of one kind; the oldest gives way.
  template <typename Sample>
  struct History {
    std::array<Sample, 32> samples{};
    std::size_t count{};

    void Push(const Sample& sample) noexcept;
    const Sample& Newest(std::size_t back = 0) const noexcept {
      return samples[(count - 1 - back) % samples.size()];
    }
    /// The two beside `time`, and how far between them it lies, 0 to 1.
    struct Between {
      const Sample& before;
      const Sample& after;
      double share{};
    };
    Between At(std::chrono::nanoseconds time) const noexcept;
  };

  History<Torque> torque_;
  History<Angles> angles_;
  std::optional<std::chrono::nanoseconds> answered_;
};

}  // namespace strainwave::bench
