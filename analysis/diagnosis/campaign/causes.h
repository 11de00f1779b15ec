// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/diagnosis/campaign/terms.h"

namespace strainwave::analysis::diagnosis {

/// What may happen in a campaign beside wear: each adds its terms and rules to the model, once for all series
/// together and once for each alone. A form for all stands before those of single series.
void AddStepChange(const LayoutPointer& layout, SeparableModel& model);
void AddSlopeChange(const LayoutPointer& layout, SeparableModel& model);
/// Follows the measured temperature; without one (or a constant one) a period of 24 h.
void AddDailyTemperature(const LayoutPointer& layout, SeparableModel& model);
/// A level shift at the very cycle from which other sensors stamped the results.
void AddSensorReplaced(const LayoutPointer& layout, SeparableModel& model);
/// What a long pause leaves and running takes away again.
void AddPauseRecovery(const LayoutPointer& layout, SeparableModel& model);

/// Nuisance terms, which have no physical cause: line over time, smooth function of load time and of
/// temperature, deviation that passes, run-in of another length.
void AddCampaignNuisanceTerms(const LayoutPointer& layout, SeparableModel& model);

}  // namespace strainwave::analysis::diagnosis
