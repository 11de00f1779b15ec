// SPDX-License-Identifier: Apache-2.0
// docs/life_forecast.svg: forecasts at 60 % of three simulated lives whose laws had no part in choosing the
// forecast's constants. To renew it, copy the picture that the failing test names.
#include <array>
#include <filesystem>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "analysis/reliability/limit_forecast.h"
#include "bench/life/campaign_lives.h"
#include "tests/analysis/simulated_lives.h"
#include "tests/checkout.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::life_forecast_picture_test {
namespace {

using analysis::reliability::LifeLaw;

TEST(LifeForecastPicture, OfTheDocumentsIsThatOfTheProgram) {
  constexpr double kSeen = 0.6;  // of the life
  const std::array laws{LifeLaw::kWornLayer, LifeLaw::kLogistic, LifeLaw::kPlantWear};
  std::mt19937_64 random(20261201);
  CampaignsReport report;
  for (const LifeLaw law : laws) {
    const auto life = analysis::reliability::DrawLife(law, random);
    CampaignLife campaign;
    campaign.specimen = NameOf(law);
    CampaignLimit limit;
    limit.quantity = "met at cycle " + std::to_string(life.met) + " in truth";
    limit.path = analysis::reliability::SeenTo(life, kSeen);
    limit.forecast = analysis::reliability::ForecastLimit(limit.path, 0.9);
    ASSERT_TRUE(limit.forecast.is_approached);
    campaign.limits.push_back(limit);
    report.campaigns.push_back(campaign);
  }
  const daq::ScratchFolder folder;
  const std::filesystem::path drawn = DrawForecasts(report, folder / "life_forecast");
  const std::string docs = SourceFolder() + "/docs/life_forecast.svg";
  const std::string picture = daq::BytesOf(drawn.string() + ".svg");
  if (picture == daq::BytesOf(docs)) return;
  const std::filesystem::path kept = std::filesystem::temp_directory_path() / "life_forecast.svg";
  daq::WriteBytes(kept, picture);
  FAIL() << docs << " is another picture than the program draws, " << kept;
}

}  // namespace
}  // namespace strainwave::bench::life_forecast_picture_test
