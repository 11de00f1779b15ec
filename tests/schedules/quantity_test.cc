// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/quantity.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace strainwave::schedules::quantity_test {
namespace {

constexpr double kRounding = 1e-15;  // relative; a conversion is one or two roundings

std::string MessageFor(std::string_view text, Dimension dimension) {
  try {
    ParseQuantity(text, dimension);
    return {};
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

struct Case {
  std::string_view text;
  Dimension dimension;
  double expected;
};

TEST(ParseQuantity, ConvertsToSi) {
  constexpr double kPi = std::numbers::pi;
  const Case cases[] = {
      {"30 min", Dimension::kTime, 1800.0},
      {"10 ms", Dimension::kTime, 0.01},
      {"7000 h", Dimension::kTime, 25'200'000.0},
      {"2400 rpm", Dimension::kAngularSpeed, 80.0 * kPi},
      {"360 deg/s", Dimension::kAngularSpeed, 2.0 * kPi},
      {"1 deg", Dimension::kAngle, kPi / 180.0},
      {"1 arcmin", Dimension::kAngle, kPi / 180.0 / 60.0},
      {"1 arcsec", Dimension::kAngle, kPi / 180.0 / 3600.0},
      {"0.5 rev", Dimension::kAngle, kPi},
      {"60 rpm/s", Dimension::kAngularAcceleration, 2.0 * kPi},
      {"40 Nm", Dimension::kTorque, 40.0},
      {"250 Ncm", Dimension::kTorque, 2.5},
      {"200 Nm/s", Dimension::kTorqueRate, 200.0},
      {"25.6 kHz", Dimension::kFrequency, 25600.0},
      {"60 degC", Dimension::kTemperature, 60.0},
      {"-20 degC", Dimension::kTemperature, -20.0},
      {"5 K", Dimension::kTemperatureDifference, 5.0},
      {"3 m/s2", Dimension::kAcceleration, 3.0},
      {"2 g", Dimension::kAcceleration, 19.6133},
      {"100 mV/g", Dimension::kSensitivity, 0.1 / 9.80665},
      {"70 %", Dimension::kShare, 0.7},
      {"0.7", Dimension::kShare, 0.7},
  };
  for (const Case& c : cases) {
    EXPECT_NEAR(ParseQuantity(c.text, c.dimension), c.expected, 2.0 * kRounding * std::abs(c.expected))
        << c.text;
  }
}

TEST(ParseQuantity, TakesOtherSpellingsOfANumberAndItsUnit) {
  EXPECT_EQ(ParseQuantity("30min", Dimension::kTime), 1800.0);
  EXPECT_EQ(ParseQuantity("  3e1   min ", Dimension::kTime), 1800.0);
  EXPECT_EQ(ParseQuantity("+.5 s", Dimension::kTime), 0.5);
  EXPECT_EQ(ParseQuantity("40 N·m", Dimension::kTorque), 40.0);
  EXPECT_EQ(ParseQuantity("40 N\u22C5m", Dimension::kTorque), 40.0);
  EXPECT_DOUBLE_EQ(ParseQuantity("5 \u00B5s", Dimension::kTime), 5e-6);
  EXPECT_DOUBLE_EQ(ParseQuantity("5 \u03BCs", Dimension::kTime), 5e-6);
  EXPECT_EQ(ParseQuantity("3 m/s²", Dimension::kAcceleration), 3.0);
  EXPECT_EQ(ParseQuantity("60 °C", Dimension::kTemperature), 60.0);
}

TEST(ParseQuantity, TakesEverySpaceOfUnicode) {
  for (const char* space :
       {"\u00A0", "\u2009", "\u202F", "\u2007", "\u3000", "\u200B", " \u00A0", "\uFEFF "}) {
    EXPECT_EQ(ParseQuantity(fmt::format("40{}Nm", space), Dimension::kTorque), 40.0) << space;
    EXPECT_EQ(ParseQuantity(fmt::format("{}40 Nm{}", space, space), Dimension::kTorque), 40.0) << space;
    EXPECT_EQ(ParseNumber(fmt::format("80{}", space)), 80.0) << space;
  }
}

TEST(ParseQuantity, NamesALetterThatLooksLikeAnother) {
  EXPECT_EQ(MessageFor("40 N\u2022m", Dimension::kTorque),
            "'N\u2022m' with U+2022 is not a unit of torque (expected Nm, mNm, Ncm or kNm)");
  EXPECT_EQ(MessageFor("\u22124 Nm", Dimension::kTorque),
            "not a number with a unit with U+2212 (expected a torque, as in '40 Nm')");
}

TEST(ParseQuantity, SaysWhichUnitsItTakes) {
  EXPECT_EQ(MessageFor("40 rpm", Dimension::kTorque),
            "'rpm' is not a unit of torque (expected Nm, mNm, Ncm or kNm)");
  EXPECT_EQ(MessageFor("40", Dimension::kTorque), "no unit (expected Nm, mNm, Ncm or kNm)");
  EXPECT_EQ(MessageFor("forty Nm", Dimension::kTorque),
            "not a number with a unit (expected a torque, as in '40 Nm')");
  EXPECT_EQ(MessageFor("5 K", Dimension::kTemperature), "'K' is not a unit of temperature (expected degC)");
  EXPECT_EQ(MessageFor("1 h", Dimension::kAngle),
            "'h' is not a unit of angle (expected arcsec, arcmin, deg, rad, mrad or rev)");
}

TEST(ParseQuantity, RefusesWhatIsNotADecimalNumber) {
  for (const char* text : {"", "Nm", "inf Nm", "nan Nm", "-inf Nm", "- 4 Nm", "+-4 Nm", ",5 Nm", "one Nm"}) {
    EXPECT_EQ(MessageFor(text, Dimension::kTorque),
              "not a number with a unit (expected a torque, as in '40 Nm')")
        << text;
  }
  EXPECT_EQ(MessageFor("2,5 Nm", Dimension::kTorque), "decimal comma (expected a point, as in '2.5 Nm')");
  EXPECT_EQ(MessageFor("0x10 Nm", Dimension::kTorque),
            "'x10 Nm' is not a unit of torque (expected Nm, mNm, Ncm or kNm)");
}

TEST(ParseQuantity, RefusesWhatCannotBe) {
  EXPECT_EQ(MessageFor("1e999 Nm", Dimension::kTorque), "out of range (expected a torque, as in '40 Nm')");
  EXPECT_EQ(MessageFor("1e306 h", Dimension::kTime), "out of range (expected a time, as in '30 min')");
  EXPECT_EQ(MessageFor("-300 degC", Dimension::kTemperature),
            "below absolute zero (expected a temperature above -273.15 degC)");
}

TEST(ParseNumber, TakesNothingButANumber) {
  EXPECT_EQ(ParseNumber("-80"), -80.0);
  EXPECT_THROW(ParseNumber("80 Nm"), std::invalid_argument);
  EXPECT_THROW(ParseNumber("nan"), std::invalid_argument);
  EXPECT_THROW(ParseNumber(""), std::invalid_argument);
}

}  // namespace
}  // namespace strainwave::schedules::quantity_test
