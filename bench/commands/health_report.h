// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/health/assess_health.h"
#include "bench/health/train_health.h"

namespace strainwave::bench {

/// In plain words on standard output. Health is cut to 0 … 1 for people; JSON has it as the network gave it.
void PrintHealthTraining(const HealthData& data, const HealthJob& job, const HealthOutcome& outcome);
void PrintAssessment(const HealthModel& model, const HealthAssessment& assessment);
void PrintWhatIf(const HealthModel& model, const Eigen::VectorXd& state,
                 const analysis::health::WhatIf& answer, const std::string& interval);

}  // namespace strainwave::bench
