// SPDX-License-Identifier: Apache-2.0
#include "daq/record.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::record_test {
namespace {

Record SmallSweep() {
  Record record;
  record.kind = RecordKind::kTransmissionError;
  record.columns.push_back(
      {"direction", std::vector{Direction::kClockwise, Direction::kCounterClockwise}, "", ""});
  record.columns.push_back({"output_angle_deg", std::vector{0.0, 1.5}, "E-17", "2024-11"});
  record.columns.push_back({"accel_x_m_per_s2", std::vector{0.25F, -0.5F}, "", ""});
  return record;
}

TEST(Record, FindsColumnsByNameAndType) {
  const Record record = SmallSweep();
  EXPECT_EQ(record.rows(), 2U);
  EXPECT_EQ(record.Doubles("output_angle_deg")[1], 1.5);
  EXPECT_EQ(record.Directions("direction")[1], Direction::kCounterClockwise);
  EXPECT_EQ(record.FindColumn("output_angle_deg")->sensor_serial, "E-17");
  EXPECT_EQ(record.FindColumn("torque_Nm"), nullptr);
  EXPECT_EQ(Record{}.rows(), 0U);
}

TEST(Record, SaysWhichColumnIsMissingOrOfAnotherType) {
  const Record record = SmallSweep();
  using Error = std::invalid_argument;
  EXPECT_EQ(MessageOf<Error>([&] { record.Doubles("torque_Nm"); }), "column 'torque_Nm' is missing");
  EXPECT_EQ(MessageOf<Error>([&] { record.Doubles("accel_x_m_per_s2"); }),
            "column 'accel_x_m_per_s2' does not hold doubles");
  EXPECT_EQ(MessageOf<Error>([&] { record.Directions("output_angle_deg"); }),
            "column 'output_angle_deg' does not hold directions");
}

TEST(Record, CopiesFloatsAndDoublesAsDoubles) {
  const Record record = SmallSweep();
  EXPECT_EQ(record.CopyAsDoubles("accel_x_m_per_s2"), (std::vector{0.25, -0.5}));
  EXPECT_EQ(record.CopyAsDoubles("output_angle_deg"), (std::vector{0.0, 1.5}));
  EXPECT_THROW(record.CopyAsDoubles("direction"), std::invalid_argument);
}

TEST(Record, KeepsMetadataInOrderAndReplacesInPlace) {
  Record record;
  record.SetMetadata("specimen", "A-3");
  record.SetMetadata("ratio", 80.0);
  record.SetMetadata("specimen", "B-4");
  EXPECT_EQ(record.metadata,
            (std::vector<std::pair<std::string, std::string>>{{"specimen", "B-4"}, {"ratio", "80"}}));
  EXPECT_EQ(record.Metadata("ratio"), "80");
  EXPECT_EQ(record.Metadata("t1_Nm"), std::nullopt);
}

TEST(Record, RefusesMetadataThatIsNoFiniteNumber) {
  Record record;
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { record.SetMetadata("ratio", std::nan("")); }),
            "metadata 'ratio' = nan is not finite");
  EXPECT_TRUE(record.metadata.empty());
}

TEST(ShortestText, ReadsBackToTheSameBits) {
  for (const double value : {0.1, 1.0 / 3.0, -0.0, 5e-324, 1.7976931348623157e308, 12345678.9, 1e22}) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(*NumberFromText(ShortestText(value))),
              std::bit_cast<std::uint64_t>(value))
        << value;
  }
  EXPECT_EQ(ShortestText(0.1), "0.1");
  EXPECT_EQ(ShortestText(0.1F), "0.1");
}

TEST(NumberFromText, TakesTheWholeTextOrNothing) {
  EXPECT_EQ(NumberFromText("+1.5e3"), 1500.0);
  EXPECT_EQ(NumberFromText("-2"), -2.0);
  EXPECT_EQ(NumberFromText("1e-400"), 0.0);
  EXPECT_TRUE(std::isnan(*NumberFromText("nan")));
  EXPECT_EQ(NumberFromText("-inf"), -std::numeric_limits<double>::infinity());
  for (const char* text : {"", "+", "+-1", "1,5", "1 ", " 1", "0x10", "1e999", "12abc", "--1"}) {
    EXPECT_EQ(NumberFromText(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace strainwave::daq::record_test
