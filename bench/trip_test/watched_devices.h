// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <utility>

#include "bench/roles/bench_clock.h"
#include "bench/roles/bench_devices.h"
#include "bench/roles/servo_drive.h"

namespace strainwave::bench {

/// When what happened, on the bench's clock. Of the control loop alone while a phase runs.
struct TripTimes {
  std::optional<std::chrono::nanoseconds> provoked;
  std::optional<std::chrono::nanoseconds> ordered;     // the first order to stop after that
  std::optional<std::chrono::nanoseconds> safe_since;  // the shafts; nothing while they are not
};

/// A bench's devices with a look at the shafts once a control period, and at the orders to stop. Whoever
/// drives them cannot tell.
class WatchedDevices {
 public:
  /// @param stands_safe  what is true of the shafts; returns at once, never throws.
  WatchedDevices(BenchDevices devices, std::function<bool()> stands_safe)
      : stands_safe_(std::move(stands_safe)),
        clock_(*this, devices.clock),
        driving_(*this, devices.driving),
        load_(*this, devices.load),
        sampler_(devices.sampler) {}
  WatchedDevices(const WatchedDevices&) = delete;
  WatchedDevices& operator=(const WatchedDevices&) = delete;

  BenchDevices Devices() { return {driving_, load_, sampler_, clock_}; }
  /// The condition is brought about now.
  void Provoked() noexcept { times_.provoked = clock_.Now(); }
  const TripTimes& times() const noexcept { return times_; }

 private:
  class Clock final : public BenchClock {
   public:
    Clock(WatchedDevices& watched, BenchClock& clock) : watched_(watched), clock_(clock) {}
    std::chrono::nanoseconds Now() const noexcept override { return clock_.Now(); }
    void SleepUntil(std::chrono::nanoseconds time) noexcept override {
      clock_.SleepUntil(time);
      watched_.Look();
    }
    std::uint64_t Overruns() const noexcept override { return clock_.Overruns(); }

   private:
    WatchedDevices& watched_;
    BenchClock& clock_;
  };

  class Servo final : public ServoDrive {
   public:
    Servo(WatchedDevices& watched, ServoDrive& drive) : watched_(watched), drive_(drive) {}
    void Enable(DriveMode mode) noexcept override { drive_.Enable(mode); }
    void Disable() noexcept override { drive_.Disable(); }
    void QuickStop() noexcept override {
      watched_.Ordered();
      drive_.QuickStop();
    }
    void ResetFault() noexcept override { drive_.ResetFault(); }
    void SetBrake(bool engaged) noexcept override { drive_.SetBrake(engaged); }
    void CommandSpeed(double value_rad_per_s) noexcept override { drive_.CommandSpeed(value_rad_per_s); }
    void CommandPosition(double value_rad) noexcept override { drive_.CommandPosition(value_rad); }
    void CommandTorque(double value_Nm) noexcept override { drive_.CommandTorque(value_Nm); }
    DriveActual Actual() const noexcept override { return drive_.Actual(); }

   private:
    WatchedDevices& watched_;
    ServoDrive& drive_;
  };

  void Ordered() noexcept {
    if (times_.provoked && !times_.ordered) times_.ordered = clock_.Now();
  }
  void Look() noexcept {
    if (!stands_safe_()) {
      times_.safe_since = std::nullopt;
    } else if (!times_.safe_since) {
      times_.safe_since = clock_.Now();
    }
  }

  std::function<bool()> stands_safe_;
  TripTimes times_;
  Clock clock_;
  Servo driving_;
  Servo load_;
  Sampler& sampler_;
};

}  // namespace strainwave::bench
