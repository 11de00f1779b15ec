// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/check_schedule.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "analysis/units.h"
#include "bench/configuration/read_drive_profile.h"
#include "bench/configuration/read_register_map.h"
#include "bench/seconds.h"
#include "schedules/reader/comparison.h"

namespace strainwave::bench {
namespace {

using schedules::Comparison;
using schedules::Named;

// What the bench can do where the schedule speaks of it: torque and speed at the gear.
struct Abilities {
  double load_torque_Nm{};
  double driving_torque_Nm{};  // at the output, if the gear lost nothing
  double load_speed_rad_per_s{};
  double sample_rate_hz{};
  double fast_sample_rate_hz{};
};

Abilities AbilitiesOf(const BenchDescription& bench, double ratio) {
  return {bench.load_servo.peak_torque_Nm * bench.load_reducer_ratio,
          bench.driving_servo.peak_torque_Nm * ratio,
          bench.load_servo.peak_speed_rad_per_s / bench.load_reducer_ratio * ratio,
          1.0 / bench.control_period_s, 1.0 / bench.fast_control_period_s};
}

constexpr const char* kLoadTorque =
    "{:.4g} Nm behind its reducer that the profile of the load servo's drive allows";

// What a drive can do by its profile, at the axis: the output of the servo's reducer.
struct DriveAbilities {
  double torque_Nm{std::numeric_limits<double>::infinity()};
  double speed_rad_per_s{std::numeric_limits<double>::infinity()};
  double acceleration_rad_per_s2{std::numeric_limits<double>::infinity()};
};

// The profiles of both drives, read once, and only where a phase asks for them.
class DrivesOnDemand {
 public:
  explicit DrivesOnDemand(const BenchDescription& bench)
      : bench_(bench), driving_file_(bench.driving_servo.drive.profile) {}

  // Of the driving servo on a CAN bus; null where it is none.
  const protocols::canopen::DriveProfile* DrivingProfile() {
    if (!driving_profile_ && !driving_file_.empty()) driving_profile_ = ReadDriveProfile(driving_file_);
    return driving_profile_ ? &*driving_profile_ : nullptr;
  }
  const DriveAbilities& Driving() {
    if (!driving_) driving_ = OfDrive(bench_.driving_servo.drive, 1.0);
    return *driving_;
  }
  const DriveAbilities& Load() {
    if (!load_) load_ = OfDrive(bench_.load_servo.drive, bench_.load_reducer_ratio);
    return *load_;
  }

 private:
  DriveAbilities OfDrive(const DriveLink& link, double reducer_ratio) const {
    if (!link.profile.empty()) {
      const auto limits = AtAxis(ReadDriveProfile(link.profile), reducer_ratio, 1).limits;
      return {limits.max_torque_Nm, limits.max_speed_rad_per_s, limits.acceleration_rad_per_s2};
    }
    const DeviceDescription* const device = FindDevice(bench_.devices, link.device);
    if (device == nullptr || device->kind != DeviceDescription::Kind::kModbus) return {};
    const ModbusProfile profile = ReadModbusProfile(device->file);
    if (!profile.servo) return {};
    const auto map = AtAxis(profile.map, *profile.servo, reducer_ratio);
    const ModbusServoRegisters at = FindServoRegisters(map, *profile.servo);
    return {LargestSetPoint(map.registers[at.torque_set_point]),
            LargestSetPoint(map.registers[at.speed_set_point])};
  }

  const BenchDescription& bench_;
  std::filesystem::path driving_file_;
  std::optional<protocols::canopen::DriveProfile> driving_profile_;
  std::optional<DriveAbilities> driving_;
  std::optional<DriveAbilities> load_;
};

class BenchCheck {
 public:
  BenchCheck(const BenchDescription& bench, DrivesOnDemand& drives, const schedules::Schedule& schedule,
             std::string path, const Comparison& compare)
      : bench_(bench),
        drives_(drives),
        ratio_(std::abs(schedule.specimen.ratio)),
        can_(AbilitiesOf(bench, ratio_)),
        t2_Nm_(schedule.specimen.t2_Nm),
        limits_(schedule.limits),
        path_(std::move(path)),
        compare_(compare) {}

  void operator()(const schedules::LoadRun& run) const {
    CheckTorque("output_torque", run.output_torque_Nm, true);
    CheckMotion(run.input_speed_rad_per_s, run.input_acceleration_rad_per_s2);
    CheckLogRate(run.log_rate_hz, can_.sample_rate_hz);
    CheckReserve("output_torque", run.output_torque_Nm, limits_.output_torque_Nm,
                 {At("torque_rate"), run.torque_rate_Nm_per_s});
    CheckReserve("input_speed", run.input_speed_rad_per_s, limits_.input_speed_rad_per_s,
                 {At("input_acceleration"), run.input_acceleration_rad_per_s2});
    if (run.vibration_statistics_hz > 0.0) {
      CheckVibration("vibration_statistics", run.vibration_statistics_hz);
      WantAccelerometers("vibration_statistics", "vibration_statistics");
    }
  }
  void operator()(const schedules::MeasurementRotation& rotation) const {
    CheckTorque("output_torque", rotation.output_torque_Nm, true);
    CheckMotion(rotation.input_speed_rad_per_s, rotation.input_acceleration_rad_per_s2);
    CheckLogRate(rotation.log_rate_hz, can_.fast_sample_rate_hz);
    CheckVibration("vibration_rate", rotation.vibration_rate_hz);
    WantAccelerometers("kind", "kind = measurement_rotation");
  }
  void operator()(const schedules::TransmissionErrorSweep& sweep) const {
    CheckPositions("transmission_error");
    CheckMotion(sweep.input_speed_rad_per_s, sweep.input_acceleration_rad_per_s2);
    CheckFollowing(sweep.input_speed_rad_per_s);
    CheckOnePeriod("averaging", sweep.averaging_s);
  }
  void operator()(const schedules::HysteresisTest& test) const {
    CheckPositions("hysteresis");
    CheckTorque("peak_torque", test.peak_torque_Nm, false);
    CheckLogRate(test.log_rate_hz, can_.sample_rate_hz);
  }
  void operator()(const schedules::Soak&) const {}
  void operator()(const schedules::BlankTest& test) const {
    CheckPositions("blank_test");
    CheckTorque("peak_torque", test.peak_torque_Nm, false);
  }
  void operator()(const schedules::SensorCheck& check) const {
    if (check.kind == schedules::SensorCheck::Kind::kZero) {
      CheckDerived({"specimen.t2", t2_Nm_}, drives_.Load().torque_Nm, kLoadTorque);
    }
    if (check.kind != schedules::SensorCheck::Kind::kShunt) return;
    compare_.MustNotExceed({At("expected"), std::abs(check.expected_Nm)}, "the torque transducer's range",
                           {"torque_transducer.range", bench_.transducer.range_Nm}, bench_.origins,
                           bench_.file_name);
    if (!bench_.simulated && bench_.transducer.shunt.device.empty()) {
      compare_.Error(At("kind"),
                     fmt::format("kind = shunt_check needs a switch for the shunt, but {} has none (expected "
                                 "torque_transducer.shunt with device and source)",
                                 bench_.file_name));
    }
  }

 private:
  std::string At(std::string_view key) const { return fmt::format("{}.{}", path_, key); }

  void CheckTorque(std::string_view key, double torque_Nm, bool driven) const {
    const Named torque{At(key), torque_Nm};
    compare_.MustNotExceed(torque, "the torque transducer's range",
                           {"torque_transducer.range", bench_.transducer.range_Nm}, bench_.origins,
                           bench_.file_name);
    CheckDerived(torque, can_.load_torque_Nm, "{:.4g} Nm of the load servo behind its reducer");
    CheckDerived(torque, drives_.Load().torque_Nm, kLoadTorque);
    // Losses only add to what the driving servo must give.
    if (!driven) return;
    CheckDerived(torque, can_.driving_torque_Nm, "{:.4g} Nm of the driving servo behind the gear");
    CheckDerived(torque, drives_.Driving().torque_Nm * ratio_,
                 "{:.4g} Nm behind the gear that the profile of the driving servo's drive allows");
  }

  void CheckMotion(double speed_rad_per_s, double acceleration_rad_per_s2) const {
    const Named speed{At("input_speed"), speed_rad_per_s};
    const ServoDescription& servo = bench_.driving_servo;
    compare_.MustNotExceed(speed, "the driving servo's peak_speed",
                           {"driving_servo.peak_speed", servo.peak_speed_rad_per_s}, bench_.origins,
                           bench_.file_name);
    if (speed.value > can_.load_speed_rad_per_s) {
      compare_.Error(
          speed.path,
          fmt::format("input_speed = {} is above the {:.4g} rpm at which the load servo "
                      "behind its reducer can follow ({})",
                      compare_.Written(speed), RpmFromRadPerS(can_.load_speed_rad_per_s), bench_.file_name));
    }
    CheckSpeed(speed, drives_.Driving().speed_rad_per_s, "the profile of the driving servo's drive allows");
    CheckSpeed(speed, drives_.Load().speed_rad_per_s * ratio_,
               "the profile of the load servo's drive lets it follow behind its reducer");
    if (acceleration_rad_per_s2 > drives_.Driving().acceleration_rad_per_s2 * (1.0 + 1e-9)) {
      const Named acceleration{At("input_acceleration"), acceleration_rad_per_s2};
      compare_.Error(acceleration.path,
                     fmt::format("input_acceleration = {} is above the {:.4g} rad/s2 that the profile of the "
                                 "driving servo's drive allows ({})",
                                 compare_.Written(acceleration), drives_.Driving().acceleration_rad_per_s2,
                                 bench_.file_name));
    }
    compare_.MustNotExceed({At("input_acceleration"), acceleration_rad_per_s2},
                           "the driving servo's max_acceleration",
                           {"driving_servo.max_acceleration", servo.max_acceleration_rad_per_s2},
                           bench_.origins, bench_.file_name);
  }

  void CheckSpeed(const Named& speed, double most_rad_per_s, std::string_view why) const {
    if (speed.value <= most_rad_per_s * (1.0 + 1e-9)) return;
    compare_.Error(speed.path, fmt::format("input_speed = {} is above the {:.4g} rpm that {} ({})",
                                           compare_.Written(speed), RpmFromRadPerS(most_rad_per_s), why,
                                           bench_.file_name));
  }

  // A drive that is led from position to position lags by the time between two of them, by a SYNC, and by
  // what its own position loop needs.
  void CheckFollowing(double speed_rad_per_s) const {
    const protocols::canopen::DriveProfile* const drive = drives_.DrivingProfile();
    if (drive == nullptr) return;
    const double lag_s = bench_.control_period_s + Seconds(drive->timing.sync_period) +
                         Seconds(drive->timing.position_loop_lag);
    const double most_rad_per_s = drive->limits.following_error_window_rad / lag_s;
    CheckDerived(
        {At("input_speed"), speed_rad_per_s}, most_rad_per_s,
        fmt::format("{:.4g} rpm at which the driving servo lags by the {:g} deg of its "
                    "following_error_window within control_period, sync_period and position_loop_lag",
                    RpmFromRadPerS(most_rad_per_s), DegFromRad(drive->limits.following_error_window_rad)));
  }

  void CheckPositions(std::string_view kind) const {
    const DeviceDescription* const device = FindDevice(bench_.devices, bench_.driving_servo.drive.device);
    if (device == nullptr || device->kind != DeviceDescription::Kind::kModbus) return;
    compare_.Error(At("kind"),
                   fmt::format("kind = {} moves the input from position to position, which a "
                               "drive on Modbus does not (expected a driving servo on CANopen in {})",
                               kind, bench_.file_name));
  }

  void WantAccelerometers(std::string_view key, std::string_view what) const {
    if (!bench_.accelerometers.empty()) return;
    compare_.Error(
        At(key), fmt::format("{} needs vibration, but {} has no accelerometers (expected at least one)", what,
                             bench_.file_name));
  }

  void CheckVibration(std::string_view key, double rate_hz) const {
    compare_.MustNotExceed({At(key), rate_hz}, "the bench's vibration_rate",
                           {"vibration_rate", bench_.vibration_rate_hz}, bench_.origins, bench_.file_name);
  }

  void CheckLogRate(double rate_hz, double most_hz) const {
    const Named rate{At("log_rate"), rate_hz};
    CheckDerived(rate, most_hz, "{:.4g} Hz at which the bench reads its channels");
  }

  // What goes on rising by the phase's own ramp is seen before it is beyond the limit.
  void CheckReserve(std::string_view key, double value, double limit, const Named& rate) const {
    const double longest_s = (limit - value) / rate.value;
    const std::string limit_path = fmt::format("limits.{}", key);
    if (bench_.control_period_s <= longest_s * (1.0 + 1e-9) || value >= limit) return;
    compare_.Error(
        At(key), fmt::format("{} = {}, rising by {} = {}, may pass {} = {} between two looks of the bench, a "
                             "control_period = {} apart (expected at most {:.3g} ms, {})",
                             key, compare_.Written({At(key), value}), schedules::KeyOf(rate.path),
                             compare_.Written(rate), limit_path, compare_.Written({limit_path, limit}),
                             Period(), 1e3 * longest_s, bench_.file_name));
  }

  void CheckOnePeriod(std::string_view key, double time_s) const {
    if (time_s >= bench_.control_period_s) return;
    const Named time{At(key), time_s};
    compare_.Error(time.path, fmt::format("{} = {} is below the bench's control_period = {} ({})", key,
                                          compare_.Written(time), Period(), bench_.file_name));
  }

  void CheckDerived(const Named& value, double most, const std::string& what) const {
    if (value.value <= most * (1.0 + 1e-9)) return;
    compare_.Error(value.path, fmt::format("{} = {} is above the {} ({})", schedules::KeyOf(value.path),
                                           compare_.Written(value), fmt::format(fmt::runtime(what), most),
                                           bench_.file_name));
  }

  std::string Period() const {
    const auto origin = bench_.origins.find("control_period");
    return origin == bench_.origins.end() ? fmt::format("{:g} s", bench_.control_period_s)
                                          : origin->second.text;
  }

  const BenchDescription& bench_;
  DrivesOnDemand& drives_;
  double ratio_;  // of the gear, without sign
  Abilities can_;
  double t2_Nm_;
  const schedules::Limits& limits_;
  std::string path_;
  const Comparison& compare_;
};

// A limit that lies beyond what measures it, or that nothing measures, watches nothing.
void CheckLimits(const schedules::Limits& limits, const BenchDescription& bench, const Comparison& compare) {
  compare.MustNotExceed({"limits.output_torque", limits.output_torque_Nm}, "the torque transducer's range",
                        {"torque_transducer.range", bench.transducer.range_Nm}, bench.origins,
                        bench.file_name);
  compare.MustNotExceed(
      {"limits.input_speed", limits.input_speed_rad_per_s}, "the driving servo's peak_speed",
      {"driving_servo.peak_speed", bench.driving_servo.peak_speed_rad_per_s}, bench.origins, bench.file_name);
  const Named vibration{"limits.vibration_rms", limits.vibration_rms_m_per_s2};
  for (std::size_t i = 0; i < bench.accelerometers.size(); ++i) {
    const AccelerometerDescription& accelerometer = bench.accelerometers[i];
    compare.MustNotExceed(vibration, fmt::format("the range of {}", accelerometer.name),
                          {fmt::format("accelerometers[{}].range", i), accelerometer.range_m_per_s2},
                          bench.origins, bench.file_name);
  }
  if (bench.accelerometers.empty()) {
    compare.Warning(vibration.path,
                    fmt::format("vibration_rms = {} watches nothing: {} has no accelerometers (expected one)",
                                compare.Written(vibration), bench.file_name));
  }
}

}  // namespace

schedules::FindingList CheckScheduleAgainstBench(const schedules::Schedule& schedule,
                                                 const BenchDescription& bench) {
  schedules::FindingList findings;
  const Comparison compare(schedule.origins, findings);
  CheckLimits(schedule.limits, bench, compare);
  DrivesOnDemand drives(bench);
  const auto check = [&](const std::vector<schedules::Phase>& phases, std::string_view list) {
    for (std::size_t i = 0; i < phases.size(); ++i) {
      const std::string path = fmt::format("{}[{}]", list, i);
      std::visit(BenchCheck(bench, drives, schedule, path, compare), phases[i].parameters);
      for (const std::string& source : phases[i].recorded_sources) {
        const DeviceDescription* const device = FindDevice(bench.devices, source);
        const bool streams = device != nullptr && (device->kind == DeviceDescription::Kind::kStream ||
                                                   device->kind == DeviceDescription::Kind::kIio);
        if (streams) continue;
        compare.Error(path + ".record",
                      fmt::format("record = {} is no source of samples (expected a device of kind stream or "
                                  "iio of {})",
                                  source, bench.file_name));
      }
    }
  };
  check(schedule.preparation, "preparation");
  check(schedule.phases, "phases");
  return findings;
}

}  // namespace strainwave::bench
