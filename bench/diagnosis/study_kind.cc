// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/study_kind.h"

namespace strainwave::bench {

std::string_view NameOf(StudyKind kind) {
  switch (kind) {
    case StudyKind::kTransmissionError:
      return "transmission_error";
    case StudyKind::kHysteresis:
      return "hysteresis";
    case StudyKind::kMotion:
      return "motion";
    case StudyKind::kVibration:
      return "vibration";
    case StudyKind::kCampaign:
      return "campaign";
  }
  return "";
}

std::optional<StudyKind> StudyKindOf(const daq::RecordKind& kind) {
  switch (kind.value()) {
    case daq::RecordKind::kTransmissionError:
      return StudyKind::kTransmissionError;
    case daq::RecordKind::kHysteresis:
      return StudyKind::kHysteresis;
    case daq::RecordKind::kMotion:
      return StudyKind::kMotion;
    case daq::RecordKind::kVibration:
      return StudyKind::kVibration;
    case daq::RecordKind::kMotor:
    case daq::RecordKind::kJoints:
    case daq::RecordKind::kHistory:
    case daq::RecordKind::kUnknown:
      return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace strainwave::bench
