// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/measure_stop_time.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/controller/jog_program.h"
#include "bench/safety/interlocks.h"
#include "bench/seconds.h"
#include "protocols/canopen/stop_time.h"

namespace strainwave::bench {

using protocols::canopen::StopTimeMeasurement;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

namespace {

constexpr nanoseconds kStillFor = milliseconds(100);
constexpr double kAtSpeedFor_s = 0.5;
constexpr double kAtSpeed = 0.9;  // of what was asked for
constexpr double kLongestWayUp_s = 10.0;

class Measurement {
 public:
  Measurement(BenchDevices devices, const StopTimeParameters& parameters,
              const std::atomic<StopRequest>& request)
      : devices_(devices), parameters_(parameters), request_(request), next_(devices.clock.Now()) {}
  Measurement(const Measurement&) = delete;
  Measurement& operator=(const Measurement&) = delete;
  ~Measurement() {
    devices_.driving.QuickStop();
    devices_.load.QuickStop();
  }

  // Until the input has turned at its speed for a while, under all limits.
  StopReason BringToSpeed() {
    const Interlocks interlocks(parameters_.limits, Nanoseconds(parameters_.stale_after_s));
    JogProgram program({JogDrive::kDriving, parameters_.input_speed_rad_per_s,
                        parameters_.input_acceleration_rad_per_s2, parameters_.period_s},
                       [](nanoseconds) { return true; });
    double way_up_s = 0.0;
    for (double at_speed_s = 0.0; at_speed_s < kAtSpeedFor_s; way_up_s += parameters_.period_s) {
      const Readings readings = devices_.sampler.Read();
      InterlockInputs inputs;
      inputs.driving = devices_.driving.Actual();
      inputs.load = devices_.load.Actual();
      inputs.now = devices_.clock.Now();
      if (const StopReason broken = interlocks.Check(readings, inputs)) return broken;
      if (const StopCause cause = CauseOf(request_.load()); cause != StopCause::kNone) {
        return {cause, 0.0, 0.0, readings.time};
      }
      if (way_up_s > kLongestWayUp_s) {
        return {StopCause::kDriveNotReady, way_up_s, kLongestWayUp_s, readings.time};
      }
      (void)program.Step(readings, way_up_s, devices_);
      const bool fast =
          std::abs(readings.input_speed_rad_per_s) > kAtSpeed * std::abs(parameters_.input_speed_rad_per_s);
      at_speed_s = fast ? at_speed_s + parameters_.period_s : 0.0;
      WaitForNextPeriod();
    }
    return {};
  }

  std::array<StopTime, 2> Watch(nanoseconds silent_since) {
    std::array<StopTimeMeasurement, 2> measured{Of(silent_since, 0), Of(silent_since, 1)};
    Readings before = devices_.sampler.Read();
    const auto waiting = [&](StopTimeMeasurement& one) {
      return one.Poll(devices_.clock.Now()) == StopTimeMeasurement::State::kWaiting;
    };
    while (request_.load() != StopRequest::kQuickStop && (waiting(measured[0]) || waiting(measured[1]))) {
      WaitForNextPeriod();
      const Readings now = devices_.sampler.Read();
      measured[0].OnPower(devices_.driving.Actual().power, devices_.clock.Now());
      measured[1].OnPower(devices_.load.Actual().power, devices_.clock.Now());
      // By the angles: what the drives say of their speed ceases with SYNC.
      const nanoseconds input_step = now.input_angle_time - before.input_angle_time;
      const nanoseconds output_step = now.output_angle_time - before.output_angle_time;
      if (std::min(input_step, output_step) <= nanoseconds::zero()) continue;
      measured[0].OnSpeed((now.input_angle_rad - before.input_angle_rad) / Seconds(input_step),
                          now.input_angle_time);
      measured[1].OnSpeed((now.output_angle_rad - before.output_angle_rad) / Seconds(output_step),
                          now.output_angle_time);
      before = now;
    }
    std::array<StopTime, 2> times;
    for (std::size_t i = 0; i < times.size(); ++i) {
      times[i] = {measured[i].left_enabled_after(), measured[i].stood_after()};
    }
    return times;
  }

 private:
  StopTimeMeasurement Of(nanoseconds silent_since, std::size_t drive) const {
    return {silent_since, parameters_.standstill_rad_per_s[drive], kStillFor, parameters_.most};
  }
  void WaitForNextPeriod() {
    next_ += Nanoseconds(parameters_.period_s);
    devices_.clock.SleepUntil(next_);
  }

  BenchDevices devices_;
  const StopTimeParameters& parameters_;
  const std::atomic<StopRequest>& request_;
  nanoseconds next_;
};

}  // namespace

StopTimes MeasureStopTimes(BenchDevices devices, const StopTimeParameters& parameters,
                           const std::function<void()>& go_silent, const std::atomic<StopRequest>& request) {
  StopTimes times;
  Measurement measurement(devices, parameters, request);
  times.ended_before = measurement.BringToSpeed();
  if (times.ended_before) return times;
  const nanoseconds silent_since = devices.clock.Now();
  go_silent();
  times.drives = measurement.Watch(silent_since);
  return times;
}

}  // namespace strainwave::bench
