// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "bench/safety/stop_reason.h"

namespace strainwave::bench {

// How long the bench may take to notice, by what tests/simulation/field, the register map of its thermometers
// and TestSettings say; StatedTimes.AreThoseOfTheFiles holds them against each other.
inline constexpr double kHeartbeat_s = 1.2;  // a drive's, waited for
inline constexpr double kMissing_s = 0.6;    // its process data
inline constexpr double kUnheard_s = 1.0;    // by a drive that hears no more of them and stops by itself
inline constexpr double kReadings_s = 1.0;   // none, and the values of a stream that has fallen silent
inline constexpr double kPoll_s = 0.2;       // of a thermometer
inline constexpr double kGoodFor_s = 2.0;    // what a thermometer has said last
inline constexpr double kBadSensor_s = 2.0;  // borne before the run is suspended
inline constexpr double kFound_s = 2.0;      // a sensor that tells nothing new (docs/requirements.md R22)
inline constexpr double kControlPeriod_s = 0.010;
inline constexpr double kSyncPeriod_s = 0.004;
inline constexpr double kDeceleration_rad_per_s2 = 5000.0;  // of a quick stop
inline constexpr double kTorqueLimit_Nm = 60.0;             // Nm
inline constexpr double kTrip_degC = 70.0;                  // degC
inline constexpr double kMostTorque_Nm = 40.0;              // Nm, the most, either way
inline constexpr double kColdest_degC = 20.0;               // degC
inline constexpr double kAtOnce_s = 0.0;                    // the drive itself says so

// Of a drive on Modbus.
inline constexpr double kStatePoll_s = 0.020;
inline constexpr double kBrakePoll_s = 0.050;  // and of its watchdog register
inline constexpr double kWritePeriod_s = 0.020;
inline constexpr double kReconnect_s = 0.100;  // the first pause before it is connected to again
inline constexpr double kWatchdog_s = 0.800;   // its own, which ends what no order reaches
inline constexpr double kAnswer_s =
    0.500;  // waited for, before the brake follows a stop that is not answered
// One poll has just begun and tells nothing yet; the next does.
inline constexpr double kState_s = 2.0 * kStatePoll_s;
inline constexpr double kBrake_s = 2.0 * kBrakePoll_s;
// Its state is read, and six requests set it up, after the pause.
inline constexpr double kConnectedAgain_s = kReconnect_s + 6.0 * kWritePeriod_s + kState_s;
// Four numbers are on their way, then it is stopped, and that is read.
inline constexpr double kCount_s = 4.0 * kWritePeriod_s + kBrake_s + kState_s;

// What is asked of a servo, and not given: borne as long, without the ramps of two reversals of a load run
// and the times to settle after them, in which nothing counts.
inline constexpr double kDwell_s = 2.0;
inline constexpr double kReversal_s = 1.0;
inline constexpr double kShortfall_s = kDwell_s + 2.0 * kReversal_s;

/// When the bench can know of a fault at all.
enum class Shows {
  kAlways,
  // A drive that has torque off and its brake on may also have its safe torque off open, or say that it is in
  // no state: a person may be at the shafts. It is asked again when it is to be enabled.
  kOnceUsed,
  kWhileUsed,          // what it had lost is set up again before it is used
  kOnceTheInputTurns,  // a shaft that stands is not told from an encoder that repeats its last value
  kOnceSpeedIsAsked,
  kOnceTorqueIsAsked,
};

/// Which drives the bench has: both on CAN; the driving servo on Modbus TCP and the load servo on a line; the
/// load servo alone on Modbus TCP.
enum class TestedBench { kCan, kModbus, kModbusLoad };

/// A fault that the device side is told to have, and what the bench should come to know of it.
struct Fault {
  std::string name;
  std::string command;  // {} in it: a part of the phase's speed, in rpm
  StopCause cause;
  std::string words;       // among those that a technician reads
  std::string mend;        // the command that takes it away again, where the bench waits for that
  double noticed_after_s;  // at most
  Shows shows{Shows::kAlways};
  BenchServo servo{BenchServo::kDriving};
  TestedBench bench{TestedBench::kCan};
  StopCause cause_while_off{StopCause::kNone};  // where it is another; noticed as a silent drive is
  StopCause or_cause{StopCause::kNone};         // which may come first
  // The drive stops, or turns slower, all at once before it is told to; a limit that this breaks may come
  // first.
  bool breaks_limits{};
};

/// Named as the rows of the table in docs/bench/faults.md are.
inline std::vector<Fault> FaultsOnCan() {
  const StopCause drive = StopCause::kDriveFault;
  const StopCause sensor = StopCause::kSensorSuspend;
  const auto load = BenchServo::kLoad;
  const auto driving = BenchServo::kDriving;
  const std::string ok = "modbus thermometers ok";
  return {
      {"heartbeat stops", "drive 1 heartbeat off", drive, "heartbeat is lost", "", kHeartbeat_s},
      // Its process data are missed before its heartbeat, and it hears nothing either.
      {"drive falls silent", "drive 2 silent on", drive, "load servo", "", kUnheard_s, Shows::kAlways, load,
       TestedBench::kCan, StopCause::kDriveSilent},
      {"drive reboots", "drive 1 reboot", drive, "started anew", "", kAtOnce_s},
      {"emergency message", "drive 2 emergency 0x4310", drive, "4310", "", kAtOnce_s},
      {"safe torque off opens", "drive 1 sto on", drive, "safe torque off is open", "", kAtOnce_s,
       Shows::kOnceUsed, driving},
      {"statusword of no state", "drive 2 statusword 0x4440", drive, "node 2", "", kAtOnce_s,
       Shows::kOnceUsed, load},
      {"drive's bus-off", "drive 1 bus-off on", drive, "node 1", "", kAtOnce_s},
      {"load servo gives 8 Nm", "drive 2 torque-limit 8", StopCause::kTorqueAway, "the load servo gives", "",
       kShortfall_s, Shows::kOnceTorqueIsAsked, load},
      {"driving servo gives a part of the speed", "drive 1 speed-limit {:.0f}", StopCause::kSpeedAway,
       "driving servo", "", kShortfall_s, Shows::kOnceSpeedIsAsked, driving, TestedBench::kCan,
       StopCause::kNone, StopCause::kNone, true},
      {"encoder stream falls silent", "stream encoders silent on", StopCause::kStaleReadings,
       "no fresh readings", "", kReadings_s},
      {"3000 encoder samples are lost", "stream encoders drop 3000", StopCause::kStaleReadings,
       "no fresh readings", "", kReadings_s},
      {"thermometer does not answer", "modbus thermometers silence", sensor, "temperature", ok,
       kGoodFor_s + kBadSensor_s},
      {"thermometer answers late", "modbus thermometers delay 1500", sensor, "temperature", ok,
       kGoodFor_s + kBadSensor_s},
      {"thermometer refuses", "modbus thermometers exception 4", sensor, "temperature", ok,
       kPoll_s + kBadSensor_s},
      {"thermometer sends half answers", "modbus thermometers half", sensor, "temperature", ok,
       kGoodFor_s + kBadSensor_s},
      {"another unit answers for the thermometer", "modbus thermometers unit", sensor, "temperature", ok,
       kGoodFor_s + kBadSensor_s},
      {"thermometer answers another question", "modbus thermometers transaction", sensor, "temperature", ok,
       kGoodFor_s + kBadSensor_s},
      {"thermometer drifts by 20 K a second", "modbus thermometers drift 0 20",
       StopCause::kTemperatureSuspend, "temperature", "modbus thermometers drift 0 0",
       (kTrip_degC - kColdest_degC) / 20.0 + kPoll_s},
      {"torque transducer repeats its last value", "sensor freeze 3", StopCause::kImplausibleReading,
       "output torque", "", kFound_s},
      {"torque transducer drifts by 40 Nm a second", "sensor drift 3 40", StopCause::kOutputTorqueLimit,
       "torque", "", (kTorqueLimit_Nm + kMostTorque_Nm) / 40.0, Shows::kAlways, driving, TestedBench::kCan,
       StopCause::kNone, StopCause::kTorqueAway},
      {"output encoder repeats its last value", "sensor freeze 1", StopCause::kImplausibleReading,
       "output angle", "", kFound_s},
      {"input encoder repeats its last value", "sensor freeze 0", StopCause::kInputAngleApart, "input angle",
       "", kFound_s, Shows::kOnceTheInputTurns},
      {"accelerometers fall silent", "stream accelerometers silent on", sensor, "vibration",
       "stream accelerometers silent off", kReadings_s + kBadSensor_s},
      {"accelerometers repeat their last value", "sensor freeze 7", sensor, "vibration", "sensor freeze off",
       kFound_s + kBadSensor_s},
      {"accelerometers are dead", "sensor dead 7", sensor, "vibration", "sensor dead off", kBadSensor_s},
      {"gear gets hot", "gear temperature 90", StopCause::kGearTemperatureLimit, "gear temperature", "",
       kPoll_s},
  };
}

/// A drive on Modbus, as the bench file and a technician call it.
struct ModbusDriveUnderTest {
  BenchServo servo;
  TestedBench bench;
  std::string device;
  std::string servo_words;  // "the driving servo"
  std::string where;        // "Modbus TCP"
};

/// Of one drive. On a line a connection cannot be lost, and answers have no number.
inline std::vector<Fault> FaultsOnModbus(const ModbusDriveUnderTest& drive, bool is_line) {
  std::vector<Fault> rows;
  const auto add = [&](const char* what, const char* command, StopCause cause, double noticed_after_s,
                       Shows shows = Shows::kAlways, StopCause while_off = StopCause::kNone) {
    const std::string name = fmt::format("{} ({}) {}", drive.servo_words.substr(4), drive.where, what);
    const bool is_of_answers = std::string_view(command).starts_with("modbus");
    rows.push_back({name, fmt::format(fmt::runtime(command), drive.device), cause, drive.servo_words, "",
                    noticed_after_s, shows, drive.servo, drive.bench, while_off, StopCause::kNone,
                    is_of_answers || shows == Shows::kWhileUsed});
  };
  const StopCause silent = StopCause::kDriveSilent;
  const StopCause dropped_out = StopCause::kDriveDroppedOut;
  add("answers nothing", "modbus {} silence", silent, kReadings_s + kAnswer_s);
  add("is unplugged", "modbus {} unplugged", silent, kReadings_s);
  add("answers late", "modbus {} delay 1500", silent, kReadings_s);
  add("sends half answers", "modbus {} half", silent, kReadings_s + kAnswer_s);
  add("answers as another unit", "modbus {} unit", silent, kReadings_s + kAnswer_s);
  add("restarts", "drive {} reboot", dropped_out, is_line ? kState_s : kConnectedAgain_s, Shows::kWhileUsed);
  if (is_line) return rows;
  add("answers another question", "modbus {} transaction", silent, kReadings_s + kAnswer_s);
  add("resets the connection", "modbus {} reset", dropped_out, kConnectedAgain_s, Shows::kWhileUsed);
  add("refuses", "modbus {} exception 4", dropped_out, kWatchdog_s, Shows::kAlways, silent);
  add("drops out of operation enabled", "drive {} sto on", dropped_out, kState_s, Shows::kOnceUsed,
      StopCause::kDriveNotReady);
  add("reports a fault", "drive {} fault", StopCause::kDriveFault, kState_s);
  add("is in no known state", "drive {} statusword 15", dropped_out, kState_s, Shows::kAlways, silent);
  add("does not follow the watchdog register", "drive {} count-stuck on", dropped_out, kCount_s,
      Shows::kOnceUsed, StopCause::kDriveNotReady);
  rows.back().or_cause = dropped_out;  // it may be enabled before that is known
  rows.back().breaks_limits = true;
  add("tells its brake wrongly", "drive {} brake-inverted on", StopCause::kBrakeEngaged, kBrake_s,
      Shows::kOnceUsed);
  if (drive.servo == BenchServo::kDriving) {
    add("repeats its last speed and position", "drive {} actual-stuck on", StopCause::kInputAngleApart,
        kFound_s, Shows::kOnceTheInputTurns);
    rows.back().words = "input angle";
    add("gives a part of the speed", "drive {} speed-limit {{:.0f}}", StopCause::kSpeedAway, kShortfall_s,
        Shows::kOnceSpeedIsAsked);
    rows.back().breaks_limits = true;  // braked all at once, the gear passes the limit of its torque
  } else {
    add("gives 8 Nm", "drive {} torque-limit 8", StopCause::kTorqueAway, kShortfall_s,
        Shows::kOnceTorqueIsAsked);
  }
  return rows;
}

/// All rows of the table in docs/bench/faults.md, in its order.
inline const std::vector<Fault>& Faults() {
  static const std::vector<Fault> all = [] {
    std::vector<Fault> rows = FaultsOnCan();
    const auto append = [&](const std::vector<Fault>& more) {
      rows.insert(rows.end(), more.begin(), more.end());
    };
    append(FaultsOnModbus(
        {BenchServo::kDriving, TestedBench::kModbus, "driving", "the driving servo", "Modbus TCP"}, false));
    append(FaultsOnModbus(
        {BenchServo::kLoad, TestedBench::kModbusLoad, "load", "the load servo", "Modbus TCP"}, false));
    append(FaultsOnModbus({BenchServo::kLoad, TestedBench::kModbus, "load", "the load servo", "Modbus RTU"},
                          true));
    return rows;
  }();
  return all;
}

}  // namespace strainwave::bench
