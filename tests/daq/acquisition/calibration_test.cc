// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/calibration.h"

#include <gtest/gtest.h>

#include "daq/acquisition/teds.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::calibration_test {
namespace {

Calibration TorqueCalibration() {
  return {.id = "T-2026-11",
          .sensor_serial = "0815",
          .sensitivity = 80,
          .zero = -12,
          .polynomial = {0.5, 2, 0.25},
          .date = DateFrom("2026-11-02"),
          .due = DateFrom("2027-11-02"),
          .teds = {{"%RefFreq", "159.2"}, {"Serial Number", "815"}}};
}

TEST(Calibration, AppliesZeroSensitivityAndPolynomial) {
  EXPECT_EQ(TorqueCalibration().Apply(148), 0.5 + 2 * 2 + 0.25 * 4);  // (148 + 12) / 80 = 2
  EXPECT_EQ((Calibration{.id = "a", .sensitivity = -4, .zero = 10}.Apply(2)), 2);
  EXPECT_EQ(Calibration{}.Apply(7), 7);
}

TEST(Calibration, SurvivesItsTextsInAFile) {
  const Calibration calibration = TorqueCalibration();
  const Attributes attributes = AttributesOf(calibration);
  EXPECT_EQ(attributes, (Attributes{{"calibration", "T-2026-11"},
                                    {"calibrated_sensor", "0815"},
                                    {"sensitivity", "80"},
                                    {"zero", "-12"},
                                    {"polynomial", "0.5 2 0.25"},
                                    {"calibration_date", "2026-11-02"},
                                    {"calibration_due", "2027-11-02"},
                                    {"%RefFreq", "159.2"},
                                    {"Serial Number", "815"}}));
  EXPECT_EQ(CalibrationFrom(attributes), calibration);
  EXPECT_TRUE(AttributesOf(Calibration{}).empty());
  EXPECT_EQ(CalibrationFrom(Attributes{{"unit", "Nm"}}), Calibration{});
}

TEST(Calibration, RefusesTextsThatSayNothing) {
  const auto message = [](const char* name, const char* text) {
    return MessageOf<std::invalid_argument>([&] { CalibrationFrom(Attributes{{name, text}}); });
  };
  EXPECT_EQ(message("sensitivity", "0"), "sensitivity = 0 scales nothing");
  EXPECT_EQ(message("sensitivity", "nan"), "sensitivity = 'nan' is not a finite number");
  EXPECT_EQ(message("zero", "two"), "zero = 'two' is not a finite number");
  EXPECT_EQ(message("polynomial", "1 x 3"), "polynomial = 'x' is not a finite number");
  EXPECT_EQ(message("sensitivity", "1e-200"),
            "sensitivity = 1e-200 is not a number of a magnitude from 1e-15 to 1e+15");
  EXPECT_EQ(message("sensitivity", "-1e16"),
            "sensitivity = -1e+16 is not a number of a magnitude from 1e-15 to 1e+15");
  EXPECT_EQ(message("zero", "1e300"), "zero = 1e+300 is not a number of a magnitude from 0 to 1e+15");
  EXPECT_EQ(message("polynomial", "0 1 1e300"),
            "polynomial = 1e+300 is not a number of a magnitude from 0 to 1e+15");
  EXPECT_EQ(message("polynomial", "0 1 2 3 4 5 6 7 8 9 10 11 12"),
            "polynomial has 13 coefficients, more than 12");
  for (const char* date :
       {"2026-02-30", "2026-1-02", "20261-02-3", "yesterday", "2026-11-02 ", "2026/11/02", ""}) {
    EXPECT_EQ(message("calibration_due", date),
              std::string("'").append(date).append("' is not a date such as 2026-11-22"));
  }
}

TEST(Calibration, BlocksOrStampsWhenItIsExpired) {
  const Calibration calibration = TorqueCalibration();
  const auto finding = [&](const char* today, ExpiredPolicy policy, const char* mounted = "0815") {
    return JudgeCalibration(calibration, "torque_Nm", mounted, DateFrom(today), policy);
  };
  EXPECT_EQ(finding("2027-11-02", ExpiredPolicy::kBlocks).verdict, CalibrationVerdict::kGood);
  EXPECT_EQ(finding("2027-11-02", ExpiredPolicy::kBlocks).reason, "");
  EXPECT_EQ(finding("2027-11-03", ExpiredPolicy::kBlocks).verdict, CalibrationVerdict::kBlocks);
  EXPECT_EQ(finding("2028-01-01", ExpiredPolicy::kStamps).verdict, CalibrationVerdict::kStamps);
  EXPECT_EQ(finding("2028-01-01", ExpiredPolicy::kStamps).reason,
            "calibration T-2026-11 of channel torque_Nm was due on 2027-11-02, 60 days ago");
  EXPECT_EQ(finding("2026-11-01", ExpiredPolicy::kBlocks).reason,
            "calibration T-2026-11 of channel torque_Nm was made on 2026-11-02, after today, 2026-11-01");
  EXPECT_EQ(finding("2027-01-01", ExpiredPolicy::kBlocks, "0816").reason,
            "calibration T-2026-11 of channel torque_Nm is of sensor 0815, but sensor 0816 is mounted");
  EXPECT_EQ(finding("2027-01-01", ExpiredPolicy::kBlocks, "").verdict, CalibrationVerdict::kGood);
  const CalibrationFinding none =
      JudgeCalibration({}, "torque_Nm", "", DateFrom("2026-01-01"), ExpiredPolicy::kBlocks);
  EXPECT_EQ(none.verdict, CalibrationVerdict::kBlocks);
  EXPECT_EQ(none.reason, "channel torque_Nm has no calibration");
}

// Put together bit by bit by hand: manufacturer 43 (14 bits), model 7115 (15), letter C = 3 (5), version 12
// (6), serial number 1 234 567 (24), from the lowest bit on.
constexpr std::array<std::uint8_t, 8> kTeds{0x2B, 0xC0, 0xF2, 0x66, 0x30, 0x87, 0xD6, 0x12};

TEST(Teds, ReadsTheFirstSixtyFourBits) {
  const BasicTeds teds{43, 7115, 'C', 12, 1234567};
  EXPECT_EQ(BasicTedsFrom(kTeds), teds);
  EXPECT_EQ(BytesOf(teds), kTeds);
  auto wrong = kTeds;
  wrong[0] = 0x10;
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { BasicTedsFrom(wrong); }),
            "Manufacturer ID = 16 is not between 17 and 16381");
  EXPECT_EQ(MessageOf<std::invalid_argument>([] {
              BytesOf({43, 40000, 'C', 12, 1});
            }),
            "Model Number = 40000 is not between 0 and 32767");
  EXPECT_EQ(MessageOf<std::invalid_argument>([] {
              BytesOf({43, 1, 'C', 12, 1U << 24});
            }),
            "Serial Number = 16777216 is not between 0 and 16777215");
}

TEST(Teds, BecomesACalibration) {
  const Attributes fields{{"%Sens@Ref", "0.0102"},    {"%Sign", "-"},        {"%RefFreq", "159.2"},
                          {"%CalDate", "2026-03-01"}, {"%CalPeriod", "365"}, {"%CalInitials", "AB"}};
  const Calibration calibration = CalibrationFromTeds({43, 7115, 'C', 12, 1234567}, fields, 3276.8);
  EXPECT_EQ(calibration.id, "TEDS 1234567 C12 2026-03-01");
  EXPECT_EQ(calibration.sensor_serial, "1234567");
  // 10.2 mV per m/s^2 upside down, 3276.8 counts a volt.
  EXPECT_NEAR(calibration.Apply(-0.0102 * 3276.8 * 9.81), 9.81, 1e-12);
  EXPECT_EQ(calibration.due, DateFrom("2027-03-01"));
  EXPECT_EQ(CalibrationFrom(AttributesOf(calibration)), calibration);
  EXPECT_EQ(MessageOf<std::invalid_argument>([] {
              CalibrationFromTeds({}, {{"%Sensitivity", "1"}}, 1);
            }),
            "'%Sensitivity' is not a field of a sensor's data sheet");
  EXPECT_EQ(MessageOf<std::invalid_argument>([] {
              CalibrationFromTeds({}, {{"%Sign", "up"}}, 1);
            }),
            "%Sign = 'up' is neither + nor -");
  EXPECT_EQ(MessageOf<std::invalid_argument>([] {
              CalibrationFromTeds({}, {{"%CalPeriod", "1"}}, 1);
            }),
            "%Sens@Ref is missing or 0, so that nothing can be scaled");
  EXPECT_EQ(MessageOf<std::invalid_argument>([] {
              CalibrationFromTeds({}, {{"%Sens@Ref", "1e306"}}, 1e4);
            }),
            "a sensitivity of inf raw per unit is none");
}

// A torque transducer: -2 to 2 mV/V for -100 to 100 Nm, bridge out of balance by 0.01 mV/V.
TEST(Teds, OfABridgeBecomesACalibration) {
  Attributes fields{{"%MinPhysVal", "-100"},    {"%MaxPhysVal", "100"},  {"%MinElecVal", "-0.00199"},
                    {"%MaxElecVal", "0.00201"}, {"%MapMeth", "0"},       {"%BridgeType", "2"},
                    {"%SensorImped", "350"},    {"%ExciteAmplNom", "5"}, {"%CalDate", "2026-03-01"},
                    {"%CalPeriod", "730"}};
  constexpr double kCountsPerRatio = 1e9;
  const Calibration calibration = CalibrationFromTeds({43, 7115, 'C', 12, 1234567}, fields, kCountsPerRatio);
  constexpr double kRounding_Nm = 1e-9;
  EXPECT_NEAR(calibration.Apply(1e4), 0.0, kRounding_Nm);
  EXPECT_NEAR(calibration.Apply(2.01e6), 100.0, kRounding_Nm);
  EXPECT_NEAR(calibration.Apply(-0.99e6), -50.0, kRounding_Nm);
  EXPECT_EQ(calibration.due, DateFrom("2028-02-29"));
  EXPECT_EQ(CalibrationFrom(AttributesOf(calibration)), calibration);
  const auto message = [&](std::size_t field, const char* text) {
    Attributes wrong = fields;
    wrong[field].second = text;
    return MessageOf<std::invalid_argument>([&] { CalibrationFromTeds({}, wrong, 1); });
  };
  EXPECT_EQ(message(1, "-100"), "a bridge from -0.00199 at -100 to 0.00201 at -100 is no line");
  EXPECT_EQ(message(3, "much"), "%MaxElecVal = 'much' is not a finite number");
  EXPECT_EQ(message(4, "1"), "%MapMeth = '1' is not the linear one, 0");
  EXPECT_EQ(message(9, "1e300"), "%CalPeriod = 1e300 is not between 0 and 4095 days");
  fields.erase(fields.begin());
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { CalibrationFromTeds({}, fields, 1); }),
            "%MinPhysVal of a bridge is missing");
}

// As an open reader of such data sheets takes them from a Brüel & Kjær 4507 (SDL-MCI/SDLMA-Core).
TEST(Teds, KnowsEveryFieldOfTheTemplateForAccelerometers) {
  for (const char* name :
       {"%Sens@Ref", "%TF_HP_S", "%Direction", "%Weight", "%Sign", "%TF_SP", "%TF_KPr", "%TF_KPq", "%TF_SL",
        "%TempCoef", "%RefFreq", "%RefTemp", "%CalDate", "%CalInitials", "%CalPeriod", "%MeasID"}) {
    EXPECT_TRUE(IsTedsField(name)) << name;
  }
  EXPECT_FALSE(IsTedsField("%TF_XX"));
}

}  // namespace
}  // namespace strainwave::daq::acquisition::calibration_test
