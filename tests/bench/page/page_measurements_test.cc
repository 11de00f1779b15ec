// SPDX-License-Identifier: Apache-2.0
#include "bench/page/measurements.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "analysis/units.h"

namespace strainwave::bench::page_measurements_test {
namespace {

PlotCurve Line(std::size_t points) {
  PlotCurve curve;
  for (std::size_t i = 0; i < points; ++i) {
    curve.x.push_back(static_cast<double>(i));
    curve.y.push_back(0.0);
  }
  return curve;
}

TEST(ThinnedCurve, KeepsWhatStandsOut) {
  PlotCurve curve = Line(100'000);
  curve.y[12'345] = 7.0;
  curve.y[54'321] = -3.0;
  const PlotCurve thinned = Thinned(curve, 100);
  EXPECT_LE(thinned.y.size(), 100U);
  EXPECT_EQ(thinned.x.size(), thinned.y.size());
  const auto high = std::ranges::find(thinned.y, 7.0);
  const auto low = std::ranges::find(thinned.y, -3.0);
  ASSERT_NE(high, thinned.y.end());
  ASSERT_NE(low, thinned.y.end());
  EXPECT_EQ(thinned.x[static_cast<std::size_t>(high - thinned.y.begin())], 12'345.0);
  EXPECT_EQ(thinned.x[static_cast<std::size_t>(low - thinned.y.begin())], 54'321.0);
}

TEST(ThinnedCurve, KeepsTheOrderOfItsPoints) {
  PlotCurve curve = Line(1000);
  for (std::size_t i = 0; i < 1000; ++i) curve.y[i] = static_cast<double>(i * 7919 % 1000);
  const PlotCurve thinned = Thinned(curve, 50);
  EXPECT_TRUE(std::ranges::is_sorted(thinned.x));
}

TEST(ThinnedCurve, HasEachPointOnce) {
  const PlotCurve thinned = Thinned(Line(1000), 50);
  EXPECT_EQ(std::ranges::adjacent_find(thinned.x, std::ranges::greater_equal()), thinned.x.end());
}

TEST(ThinnedCurve, OfFewPointsIsTheCurve) {
  const PlotCurve curve = Line(50);
  EXPECT_EQ(Thinned(curve, 50).x, curve.x);
  EXPECT_TRUE(Thinned({}, 50).x.empty());
}

TEST(Measurements, ThatAreNotThereAreNull) {
  const nlohmann::json json = MeasurementsJson(3, {});
  EXPECT_EQ(json["cycle"], 3);
  EXPECT_TRUE(json["hysteresis"].is_null());
  EXPECT_TRUE(json["transmission_error"].is_null());
  EXPECT_TRUE(json["spectrum"].is_null());
}

TEST(Measurements, OfOneDirectionHaveNoneOfTheOther) {
  CycleCurves curves;
  curves.analysis.transmission_error.emplace();
  auto& cw = curves.analysis.transmission_error->cw.emplace();
  cw.output_angle_rad = {RadFromDeg(0.0), RadFromDeg(90.0), RadFromDeg(180.0)};
  cw.error_rad = {0.0, RadFromDeg(1.0 / 60.0), std::nan("")};
  const nlohmann::json json = MeasurementsJson(3, curves)["transmission_error"];
  EXPECT_EQ(json["cw"]["angle_deg"], nlohmann::json({0.0, 90.0, 180.0}));
  EXPECT_EQ(json["cw"]["error_arcmin"], nlohmann::json({0.0, 1.0, nullptr})) << "what is no number is null";
  EXPECT_TRUE(json["ccw"].is_null());
}

}  // namespace
}  // namespace strainwave::bench::page_measurements_test
