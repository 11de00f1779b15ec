// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "daq/record_kind.h"

namespace strainwave::bench {

/// What can be diagnosed: records of one kind, or the results over the cycles of a campaign.
enum class StudyKind { kTransmissionError, kHysteresis, kMotion, kVibration, kCampaign };

/// As files have it: "transmission_error", "campaign".
std::string_view NameOf(StudyKind kind);

/// Nothing for a kind of record that is not diagnosed.
std::optional<StudyKind> StudyKindOf(const daq::RecordKind& kind);

}  // namespace strainwave::bench
