// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/make_program.h"

#include "analysis/units.h"
#include "bench/controller/hysteresis_program.h"
#include "bench/controller/load_run_program.h"
#include "bench/controller/rotation_program.h"
#include "bench/controller/sensor_check_program.h"
#include "bench/controller/sequence_program.h"
#include "bench/controller/standstill_programs.h"
#include "bench/controller/sweep_program.h"

namespace strainwave::bench {
namespace {

constexpr double kBlankRatio = 1.0;
constexpr double kBlankLogRate_hz = 50.0;

// With a rigid shaft in the gear's place, the lock test sees only the bench's own compliance, and one turn of
// the driving servo is one turn of both encoders.
std::unique_ptr<PhaseProgram> MakeBlankProgram(const schedules::BlankTest& blank,
                                               const schedules::Specimen& specimen, double period_s) {
  schedules::HysteresisTest ramp;
  ramp.peak_torque_Nm = blank.peak_torque_Nm;
  ramp.torque_rate_Nm_per_s = blank.torque_rate_Nm_per_s;
  ramp.log_rate_hz = kBlankLogRate_hz;
  ramp.lock_angles_rad = {0.0};
  schedules::TransmissionErrorSweep turn;
  turn.steps = blank.steps;
  turn.step_rad = kTwoPi / blank.steps;
  turn.counter_clockwise = false;
  turn.input_speed_rad_per_s = RadPerSFromRpm(20.0);
  turn.input_acceleration_rad_per_s2 = 20.0;
  turn.settle_s = 0.1;
  turn.averaging_s = 0.1;
  std::vector<std::unique_ptr<PhaseProgram>> programs;
  programs.push_back(std::make_unique<HysteresisProgram>(ramp, specimen, period_s));
  programs.push_back(std::make_unique<SweepProgram>(turn, kBlankRatio, period_s));
  return std::make_unique<SequenceProgram>(std::move(programs), "blank_");
}

struct Maker {
  const schedules::Specimen& specimen;
  double credited_load_s;
  double period_s;

  std::unique_ptr<PhaseProgram> operator()(const schedules::LoadRun& phase) const {
    return std::make_unique<LoadRunProgram>(phase, specimen, credited_load_s, period_s);
  }
  std::unique_ptr<PhaseProgram> operator()(const schedules::MeasurementRotation& phase) const {
    return std::make_unique<RotationProgram>(phase, specimen);
  }
  std::unique_ptr<PhaseProgram> operator()(const schedules::TransmissionErrorSweep& phase) const {
    return std::make_unique<SweepProgram>(phase, specimen.ratio, period_s);
  }
  std::unique_ptr<PhaseProgram> operator()(const schedules::HysteresisTest& phase) const {
    return std::make_unique<HysteresisProgram>(phase, specimen, period_s);
  }
  std::unique_ptr<PhaseProgram> operator()(const schedules::Soak& phase) const {
    return std::make_unique<SoakProgram>(phase);
  }
  std::unique_ptr<PhaseProgram> operator()(const schedules::BlankTest& phase) const {
    return MakeBlankProgram(phase, specimen, period_s);
  }
  std::unique_ptr<PhaseProgram> operator()(const schedules::SensorCheck& phase) const {
    return std::make_unique<SensorCheckProgram>(phase, specimen, period_s);
  }
};

struct EventOf {
  BenchEvent operator()(const schedules::LoadRun&) const { return BenchEvent::kBeginLoadRun; }
  BenchEvent operator()(const schedules::MeasurementRotation&) const {
    return BenchEvent::kBeginMeasurementRotation;
  }
  BenchEvent operator()(const schedules::TransmissionErrorSweep&) const {
    return BenchEvent::kBeginTransmissionErrorSweep;
  }
  BenchEvent operator()(const schedules::HysteresisTest&) const { return BenchEvent::kBeginHysteresisTest; }
  BenchEvent operator()(const schedules::Soak&) const { return BenchEvent::kBeginSoak; }
  BenchEvent operator()(const schedules::BlankTest&) const { return BenchEvent::kBeginBlankTest; }
  BenchEvent operator()(const schedules::SensorCheck&) const { return BenchEvent::kBeginSensorCheck; }
};

}  // namespace

std::unique_ptr<PhaseProgram> MakeProgram(const schedules::PhaseParameters& phase,
                                          const schedules::Specimen& specimen, double credited_load_s,
                                          double period_s) {
  return std::visit(Maker{specimen, credited_load_s, period_s}, phase);
}

BenchEvent BeginEvent(const schedules::PhaseParameters& phase) { return std::visit(EventOf{}, phase); }

}  // namespace strainwave::bench
