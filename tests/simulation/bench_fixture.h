// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <limits>
#include <memory>

#include "analysis/units.h"
#include "bench/controller/phase_runner.h"
#include "bench/machines/simulated_machine.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Passes every call on to a drive and keeps what a test asks about.
class SpyDrive final : public ServoDrive {
 public:
  SpyDrive(ServoDrive& drive, const BenchClock& clock) : drive_(drive), clock_(clock) {}

  void Enable(DriveMode mode) noexcept override {
    enabled_at = clock_.Now();
    if (!ignores_enable) drive_.Enable(mode);
  }
  void Disable() noexcept override { drive_.Disable(); }
  void QuickStop() noexcept override {
    last_quick_stop_at = clock_.Now();
    if (quick_stop_at <= enabled_at) quick_stop_at = last_quick_stop_at;
    set_points_after_stop = 0;
    drive_.QuickStop();
    ++quick_stops;
    quick_stops.notify_all();
  }
  void ResetFault() noexcept override { drive_.ResetFault(); }
  void SetBrake(bool engaged) noexcept override { drive_.SetBrake(engaged); }
  void CommandSpeed(double value) noexcept override {
    ++set_points_after_stop;
    drive_.CommandSpeed(share * value);
  }
  void CommandPosition(double value) noexcept override {
    ++set_points_after_stop;
    drive_.CommandPosition(value);
  }
  void CommandTorque(double value) noexcept override {
    ++set_points_after_stop;
    drive_.CommandTorque(share * value);
  }
  DriveActual Actual() const noexcept override {
    if (!silent) told_ = drive_.Actual();
    DriveActual actual = told_;
    if (dropped_out) actual.power = protocols::PowerState::kSwitchOnDisabled;
    return actual;
  }

  std::chrono::nanoseconds enabled_at{-1};
  std::chrono::nanoseconds quick_stop_at{-1};  // the first since it was enabled
  std::chrono::nanoseconds last_quick_stop_at{-1};
  int set_points_after_stop{};
  bool ignores_enable{};  // never gets enabled
  bool dropped_out{};     // says so, without a fault
  bool silent{};          // says what it said last
  double share{1.0};      // that it gives of the speed or torque asked for
  std::atomic<int> quick_stops{};

 private:
  ServoDrive& drive_;
  const BenchClock& clock_;
  mutable DriveActual told_;
};

inline schedules::Specimen TestSpecimen() {
  schedules::Specimen specimen;
  specimen.identity = "TEST";
  specimen.ratio = 80.0;
  specimen.t1_Nm = 7.0;
  specimen.t2_Nm = 25.0;
  specimen.t3_Nm = 34.0;
  specimen.rated_torque_Nm = 34.0;
  return specimen;
}

inline RunnerSettings TestSettings() {
  RunnerSettings settings;
  settings.limits.output_torque_Nm = 60.0;
  settings.limits.input_speed_rad_per_s = RadPerSFromRpm(3000.0);
  settings.limits.gear_temperature_degC = 75.0;
  settings.limits.vibration_rms_m_per_s2 = 50.0;
  settings.limits.twist_rad = RadFromArcmin(30.0);
  settings.suspend.trip_temperature_degC = 70.0;
  settings.suspend.resume_temperature_degC = 60.0;
  settings.suspend.dwell_s = 5.0;
  settings.suspend.bad_sensor_s = 2.0;
  settings.suspend.give_up_s = 4.0 * 3600.0;
  return settings;
}

inline schedules::LoadRun TestLoadRun(double duration_s) {
  schedules::LoadRun run;
  run.duration_s = duration_s;
  run.output_torque_Nm = 40.0;
  run.input_speed_rad_per_s = RadPerSFromRpm(2400.0);
  run.input_acceleration_rad_per_s2 = 1000.0;
  run.torque_rate_Nm_per_s = 200.0;
  run.log_rate_hz = 10.0;
  return run;
}

inline schedules::MeasurementRotation TestRotation() {
  schedules::MeasurementRotation rotation;
  rotation.input_speed_rad_per_s = RadPerSFromRpm(2400.0);
  rotation.output_torque_Nm = 40.0;
  rotation.input_acceleration_rad_per_s2 = 1000.0;
  rotation.log_rate_hz = 1000.0;
  return rotation;
}

inline schedules::TransmissionErrorSweep TestSweep() {
  schedules::TransmissionErrorSweep sweep;
  sweep.step_rad = RadFromDeg(1.0);
  sweep.steps = 360;
  sweep.input_speed_rad_per_s = RadPerSFromRpm(300.0);
  sweep.input_acceleration_rad_per_s2 = 1000.0;
  sweep.settle_s = 0.1;
  sweep.averaging_s = 0.05;
  return sweep;
}

inline schedules::HysteresisTest TestHysteresis() {
  schedules::HysteresisTest test;
  test.peak_torque_Nm = 34.0;
  test.torque_rate_Nm_per_s = 3.0;
  test.hold_s = 0.5;
  test.log_rate_hz = 50.0;
  test.lock_angles_rad = {0.0, kPi / 2.0};
  return test;
}

/// A simulated bench with spies on both drives, and a runner on it.
class SpiedBench {
 public:
  explicit SpiedBench(const RunnerSettings& settings = TestSettings())
      : machine(analysis::model::DefaultPlantModel(), {}, {}),
        driving(machine.bench().driving_servo(), machine.bench().clock()),
        load(machine.bench().load_servo(), machine.bench().clock()),
        devices{driving, load, machine.bench().sampler(), machine.bench().clock()},
        runner(devices, settings, request) {}

  bool Safe() {
    const auto off = [](const DriveActual& drive) {
      return drive.brake_engaged && drive.power != protocols::PowerState::kOperationEnabled;
    };
    // Whatever the spies were told to say.
    return off(machine.bench().driving_servo().Actual()) && off(machine.bench().load_servo().Actual());
  }

  std::atomic<StopRequest> request{StopRequest::kNone};
  SimulatedMachine machine;
  SpyDrive driving;
  SpyDrive load;
  BenchDevices devices;
  PhaseRunner runner;
};

inline void NoHeartbeat(const PhaseSnapshot&, const PhaseProgram&) {}

}  // namespace strainwave::bench
