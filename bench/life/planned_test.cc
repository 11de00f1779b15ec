// SPDX-License-Identifier: Apache-2.0
#include "bench/life/planned_test.h"

#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/reliability/test_plan.h"

namespace strainwave::bench {
namespace {

namespace reliability = analysis::reliability;

constexpr int kMostFailures = 2;
constexpr int kSpecimens[] = {1, 2, 3, 4, 6, 10, 20};

std::string Specimens(const std::optional<int>& number) {
  return number ? fmt::format("{}", *number) : "more than 100000";
}

}  // namespace

PlannedTest PlanTest(const LifeToShow& wanted) {
  if (!(wanted.campaign_h > 0.0))
    throw std::invalid_argument("the campaign loads nothing: it shows no life (expected a load_run)");
  PlannedTest plan{wanted, {}, {}};
  for (int failures = 0; failures <= kMostFailures; ++failures) {
    const reliability::Demonstration shown{.share_failed = 0.1,
                                           .life = wanted.b10_h,
                                           .confidence = wanted.confidence,
                                           .shape = wanted.shape,
                                           .failures_allowed = failures};
    plan.specimens.push_back(reliability::UnitsToShow(shown, wanted.campaign_h));
    for (const int specimens : kSpecimens) {
      if (specimens <= failures) continue;
      const double hours = reliability::TestTimeToShow(shown, specimens);
      plan.rows.push_back({specimens, failures, hours, hours / wanted.campaign_h,
                           reliability::LifeShown(shown, specimens, wanted.campaign_h),
                           reliability::ChanceToPass(shown, specimens, hours, 2.0 * wanted.b10_h)});
    }
  }
  return plan;
}

std::string TextOf(const PlannedTest& plan) {
  const LifeToShow& wanted = plan.wanted;
  std::string text = fmt::format(
      "\ntest planning: to show B10 >= {:g} h at the rated load with {:g} % confidence, where the shape is "
      "{:.3g}\n"
      "  one campaign is {:.1f} h at the rated load (cube law)\n"
      "  {:>9} {:>16} {:>16} {:>14} {:>20} {:>16}\n",
      wanted.b10_h, 100.0 * wanted.confidence, wanted.shape, wanted.campaign_h, "specimens",
      "failures allowed", "rated hours each", "campaigns each", "one campaign: B10 >=", "passed if twice");
  for (const PlannedRow& row : plan.rows)
    text += fmt::format("  {:>9} {:>16} {:>14.0f} h {:>14.2f} {:>18.0f} h {:>14.0f} %\n", row.specimens,
                        row.failures_allowed, row.hours, row.campaigns, row.b10_shown_h,
                        100.0 * row.chance_to_pass);
  for (std::size_t failures = 0; failures < plan.specimens.size(); ++failures)
    text += fmt::format("  with one campaign each and {} failures allowed: {} specimens\n", failures,
                        Specimens(plan.specimens[failures]));
  return text;
}

nlohmann::json JsonOf(const PlannedTest& plan) {
  nlohmann::json rows = nlohmann::json::array();
  for (const PlannedRow& row : plan.rows)
    rows.push_back({{"specimens", row.specimens},
                    {"failures_allowed", row.failures_allowed},
                    {"rated_h_each", row.hours},
                    {"campaigns_each", row.campaigns},
                    {"b10_shown_by_one_campaign_h", row.b10_shown_h},
                    {"chance_to_pass_at_twice_the_life", row.chance_to_pass}});
  nlohmann::json specimens = nlohmann::json::array();
  for (const auto& number : plan.specimens)
    specimens.push_back(number ? nlohmann::json(*number) : nlohmann::json());
  return {{"b10_h", plan.wanted.b10_h},
          {"confidence", plan.wanted.confidence},
          {"shape", plan.wanted.shape},
          {"campaign_rated_h", plan.wanted.campaign_h},
          {"specimens_for_one_campaign_each", specimens},
          {"plans", rows}};
}

}  // namespace strainwave::bench
