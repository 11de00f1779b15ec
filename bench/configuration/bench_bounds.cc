// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/bench_bounds.h"

namespace strainwave::bench {

using schedules::Dimension;
using schedules::QuantityBound;

namespace {

constexpr const char* kUnwatched = "2 s";  // kLongestUnwatched_s
constexpr const char* kTurnsUnwatched = "the shafts turn unwatched meanwhile";
constexpr const char* kPeriod = "limits are looked at once a period, and drives take set points no faster";
constexpr const char* kStartWaits = "what comes later is not coming";

constexpr QuantityBound kOfBench[] = {
    {"control_period", Dimension::kTime, "100 us", "100 ms", kPeriod},
    {"fast_control_period", Dimension::kTime, "100 us", "100 ms", kPeriod},
    {"stale_after", Dimension::kTime, "", kUnwatched, kTurnsUnwatched},
    {"longest_stop_time", Dimension::kTime, "", "10 s", kTurnsUnwatched},
    {"peak_torque", Dimension::kTorque, "", "10 kNm", "no servo of a bench has more"},
    {"load_reducer_ratio", std::nullopt, "", "1000", "no reducer of a bench has more"},
    {"linearity", Dimension::kShare, "", "20 %", "what is so far off is no transducer"},
    {"gain_uncertainty", Dimension::kShare, "", "20 %", "what is so far off is no transducer"},
    {"accuracy", Dimension::kAngle, "", "1 deg", "what is so far off is no encoder to measure with"},
    {"blank_reference_accuracy", Dimension::kAngle, "", "1 deg", "what is so far off is no reference"},
    {"set_point", Dimension::kTemperature, "", "150 degC",
     "the grease, seals and bearings of a gear bear no more"},
    {"simulation.time_skew", Dimension::kTime, "", "1 s", "no two encoders are read that far apart"},
};

constexpr QuantityBound kOfDevices[] = {
    // CANopen: who watches whom.
    {"drive_heartbeat", Dimension::kTime, "", kUnwatched, kTurnsUnwatched},
    {"drive_timeout", Dimension::kTime, "", kUnwatched, kTurnsUnwatched},
    {"master_heartbeat", Dimension::kTime, "", kUnwatched, kTurnsUnwatched},
    {"master_timeout", Dimension::kTime, "", kUnwatched, kTurnsUnwatched},
    {"rpdo_event_timer", Dimension::kTime, "", kUnwatched, kTurnsUnwatched},
    {"following_error_time", Dimension::kTime, "", kUnwatched, kTurnsUnwatched},
    {"most_sync_deviation", Dimension::kTime, "", kUnwatched, kTurnsUnwatched},
    {"stop_timeout", Dimension::kTime, "", "10 s", kTurnsUnwatched},
    {"sync_period", Dimension::kTime, "100 us", "100 ms", kPeriod},
    {"position_loop_lag", Dimension::kTime, "", "1 s", "a drive so far behind follows nothing"},
    {"sdo_timeout", Dimension::kTime, "", "1 min", kStartWaits},
    {"start_timeout", Dimension::kTime, "", "1 min", kStartWaits},
    {"stage_timeout", Dimension::kTime, "", "1 min", kStartWaits},
    {"mode_timeout", Dimension::kTime, "", "1 min", kStartWaits},
    {"reset_hold", Dimension::kTime, "", "10 s", kStartWaits},
    {"standstill_speed", Dimension::kAngularSpeed, "", "60 rpm", "a shaft that turns so fast does not stand"},
    // Modbus and HID.
    {"write_period", Dimension::kTime, "1 ms", "500 ms", "set points and stops wait for it"},
    {"watchdog_time", Dimension::kTime, "", kUnwatched, kTurnsUnwatched},
    {"poll", Dimension::kTime, "1 ms", "1 min", "a value that is read so seldom watches nothing"},
    {"request_period", Dimension::kTime, "1 ms", "1 min", "a value that is read so seldom watches nothing"},
    {"good_for", Dimension::kTime, "", "3 min", "an older value is none"},
};

}  // namespace

std::span<const QuantityBound> BenchBounds() { return kOfBench; }
std::span<const QuantityBound> DeviceBounds() { return kOfDevices; }

}  // namespace strainwave::bench
