// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/schedule_bounds.h"

namespace strainwave::schedules {
namespace {

constexpr QuantityBound kBounds[] = {
    // What stops the bench: a limit that nothing reaches is none.
    {"limits.gear_temperature", Dimension::kTemperature, "", "150 degC",
     "the grease, seals and bearings of such a gear bear no more"},
    {"limits.input_speed", Dimension::kAngularSpeed, "", "15000 rpm", "no wave generator is made for more"},
    {"limits.vibration_rms", Dimension::kAcceleration, "", "500 m/s2",
     "accelerometers of the usual 50 g show no more"},
    {"limits.twist", Dimension::kAngle, "", "5 deg", "teeth have jumped by then"},
    {"stop.e_max_above", Dimension::kAngle, "", "1 deg", "a gear that still turns has no such error"},
    {"stop.vibration_rms_above", Dimension::kAcceleration, "", "500 m/s2",
     "accelerometers of the usual 50 g show no more"},
    // What suspends it: the load goes on until it does.
    {"suspend.bad_sensor", Dimension::kTime, "", "1 min",
     "the load goes on meanwhile, and nothing is known of what the channel watches"},
    {"suspend.dwell", Dimension::kTime, "", "24 h", "a gear is cold by then"},
    {"suspend.give_up", Dimension::kTime, "", "7 d", "a bench that has stood for so long needs a person"},
    {"resume.re_soak_after", Dimension::kTime, "", "24 h", "a gear is cold by then"},
    {"resume.longest_pause", Dimension::kTime, "", "365 d", "grease and room are others by then"},
    {"measurements.temperature_tolerance", Dimension::kTemperatureDifference, "", "50 K",
     "a stiffness at one end of it says nothing of one at the other"},
    // The specimen.
    {"specimen.ratio", std::nullopt, "", "1000", "no strain wave gear has more"},
    {"specimen.rated_speed", Dimension::kAngularSpeed, "", "15000 rpm", "no wave generator is made for more"},
    {"specimen.bearing_l10", Dimension::kTime, "", "1000000 h", "no bearing's life is known for longer"},
    // The phases.
    {"duration", Dimension::kTime, "", "10000 h", "a longer load belongs into several cycles"},
    {"turns", std::nullopt, "0.001", "100000", "the output reverses after each"},
    {"settle", Dimension::kTime, "", "10 min", "it is waited at each of hundreds of steps"},
    {"averaging", Dimension::kTime, "", "10 min", "it is waited at each of hundreds of steps"},
    {"hold", Dimension::kTime, "", "1 h", "what creeps for longer is not the loop any more"},
    {"at_most", Dimension::kTime, "", "30 d", "a gear is as cold as the room by then"},
    {"lock_angles", Dimension::kAngle, "", "100 rev", "the error of an encoder comes back each turn"},
    {"log_rate", Dimension::kFrequency, "0.001 Hz", "100 kHz",
     "slow channels are read no faster, nor seldomer"},
    {"input_speed", Dimension::kAngularSpeed, "0.01 rpm", "15000 rpm",
     "a phase must end, and no wave generator is made for more"},
    {"input_acceleration", Dimension::kAngularAcceleration, "0.1 rad/s2", "1000000 rad/s2",
     "a ramp must end, and no servo does more"},
    {"torque_rate", Dimension::kTorqueRate, "0.001 Nm/s", "10000 Nm/s",
     "a ramp must end, and be seen before it has passed a limit"},
    {"allowed", Dimension::kAngle, "", "3 deg", "a coupling that has slipped shows less"},
    {"noise", Dimension::kAngle, "", "1 deg", "an encoder at standstill shows less"},
};

}  // namespace

std::span<const QuantityBound> ScheduleBounds() { return kBounds; }

}  // namespace strainwave::schedules
