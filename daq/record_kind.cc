// SPDX-License-Identifier: Apache-2.0
#include "daq/record_kind.h"

#include <array>
#include <utility>

namespace strainwave::daq {
namespace {

constexpr std::array<std::pair<RecordKind::Value, std::string_view>, 7> kKindNames{
    {{RecordKind::kTransmissionError, "transmission_error"},
     {RecordKind::kHysteresis, "hysteresis"},
     {RecordKind::kMotion, "motion"},
     {RecordKind::kVibration, "vibration"},
     {RecordKind::kMotor, "motor"},
     {RecordKind::kJoints, "joints"},
     {RecordKind::kHistory, "history"}}};

}  // namespace

RecordKind RecordKind::Named(std::string_view name) {
  for (const auto& [value, known] : kKindNames) {
    if (known == name) return value;
  }
  RecordKind kind;
  kind.unknown_ = name;
  return kind;
}

std::string_view RecordKind::name() const {
  for (const auto& [value, known] : kKindNames) {
    if (value == value_) return known;
  }
  return unknown_;
}

}  // namespace strainwave::daq
