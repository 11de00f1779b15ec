// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/schedule.h"

namespace strainwave::schedules {
namespace {

struct KindNames {
  std::string operator()(const LoadRun&) const { return "load_run"; }
  std::string operator()(const MeasurementRotation&) const { return "measurement_rotation"; }
  std::string operator()(const TransmissionErrorSweep&) const { return "transmission_error"; }
  std::string operator()(const HysteresisTest&) const { return "hysteresis"; }
  std::string operator()(const Soak&) const { return "soak"; }
  std::string operator()(const BlankTest&) const { return "blank_test"; }
  std::string operator()(const SensorCheck& check) const {
    switch (check.kind) {
      case SensorCheck::Kind::kZero:
        return "zero_check";
      case SensorCheck::Kind::kShunt:
        return "shunt_check";
      case SensorCheck::Kind::kReference:
        return "reference_check";
    }
    return "?";
  }
};

}  // namespace

std::string KindName(const PhaseParameters& parameters) { return std::visit(KindNames{}, parameters); }

}  // namespace strainwave::schedules
