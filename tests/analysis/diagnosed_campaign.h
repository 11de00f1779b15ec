// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "analysis/diagnosis/diagnose.h"
#include "tests/analysis/campaign_generator.h"

namespace strainwave::analysis::diagnosis {

using Random = std::mt19937;
using Hide =
    std::function<void(CampaignDrawing& drawing, double from_cycle, std::size_t series, Random& random)>;

inline double Uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

struct Case {
  std::unique_ptr<Study> study;
  Diagnosis diagnosis;
  double from_cycle{};
  std::size_t series{};
  double scatter{};

  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const Finding& finding : diagnosis.causes) names.push_back(study->causes()[finding.index].name);
    return names;
  }
  bool Only(const std::string& name) const {
    const std::vector<std::string> names = Names();
    return !names.empty() &&
           std::all_of(names.begin(), names.end(), [&](const auto& n) { return n == name; });
  }
  // Of the first cause that has it; NaN where none has.
  ParameterValue Parameter(const std::string& name) const {
    for (const Finding& finding : diagnosis.causes) {
      for (const ParameterValue& value : finding.parameters) {
        if (value.name == name) return value;
      }
    }
    return {name, "", std::numeric_limits<double>::quiet_NaN(), 0.0};
  }
};

/// Draws a campaign, hides something in it and diagnoses it.
inline Case DiagnosedCampaign(unsigned seed, std::size_t cycles, const Hide& hide) {
  CampaignDrawing drawing(seed, cycles);
  Random random(seed + 100000);
  Case result;
  result.from_cycle = std::floor(static_cast<double>(cycles) * Uniform(random, 0.2, 0.8));
  result.series = static_cast<std::size_t>(Uniform(random, 0.0, 6.0));
  result.scatter = drawing.scatter[result.series];
  hide(drawing, result.from_cycle, result.series, random);
  result.study = MakeCampaignStudy(drawing.data);
  result.diagnosis = Diagnose(*result.study);
  return result;
}

}  // namespace strainwave::analysis::diagnosis
