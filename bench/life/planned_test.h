// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace strainwave::bench {

/// A life that a test is to show, and what one campaign contributes to it.
struct LifeToShow {
  double b10_h{};          // at the rated load
  double confidence{0.9};  // of B10 being at least that
  double shape{};
  double campaign_h{};  // one whole campaign, as hours at the rated load with equal damage (cube law)
  int cycles{};         // of it
};

/// Of one number of specimens: how long each is to run.
struct PlannedRow {
  int specimens{};
  int failures_allowed{};
  double hours{};           // at the rated load
  double campaigns{};       // of that schedule
  double b10_shown_h{};     // by one campaign each instead
  double chance_to_pass{};  // where the truth is twice the life
};

struct PlannedTest {
  LifeToShow wanted;
  std::vector<PlannedRow> rows;
  std::vector<std::optional<int>> specimens;  // for one campaign each, with 0, 1, 2 failures allowed
};

/// @throws std::invalid_argument for a life, confidence or shape out of its range, or a campaign without
/// load.
PlannedTest PlanTest(const LifeToShow& wanted);

std::string TextOf(const PlannedTest& plan);
nlohmann::json JsonOf(const PlannedTest& plan);

}  // namespace strainwave::bench
