// SPDX-License-Identifier: Apache-2.0
#include "tests/daq/csv_sample.h"

namespace strainwave::daq::csv_limits_test {
namespace {

TEST(CsvLimits, RefusesWhatAQuantityCannotBeWithItsPlace) {
  EXPECT_EQ(ErrorOf(Replaced(kLoop, "-2.5", "1e200")),
            "r.csv:5:5: error: torque_Nm is 1e+200 (expected a number from -1e+06 to 1e+06 Nm)");
  EXPECT_EQ(ErrorOf(Replaced(kLoop, "0.02", "-1.5e308")),
            "r.csv:5:10: error: output_angle_deg is -1.5e+308 (expected a number from -1e+12 to 1e+12 deg)");
  EXPECT_EQ(ErrorOf(Replaced(kLoop, "0.2,", "3e11,")),
            "r.csv:6:1: error: time_s is 300000000000 (expected a number from -1e+11 to 1e+11 s)");
  EXPECT_EQ(ErrorOf(Replaced(kLoop, "t1_Nm: 7", "t1_Nm: 1e-300")),
            "r.csv:2:10: error: t1_Nm is 1e-300 (expected a number of 1e-15 or more)");
  EXPECT_EQ(ErrorOf(Replaced(kLoop, "t1_Nm: 7", "lock_angle_deg: 1e300")),
            "r.csv:2:19: error: lock_angle_deg is 1e300 (expected a number from -1e+12 to 1e+12 deg)");
  EXPECT_EQ(ErrorOf("# kind: transmission_error\n# ratio: 1e300\ndirection,input_angle_deg,output_angle_deg\n"
                    "cw,0,0\n"),
            "r.csv:2:10: error: ratio is 1e300 (expected a number from -1e+06 to 1e+06)");
  EXPECT_EQ(ErrorOf("# kind: vibration\n# sample_rate_hz: 1e-300\naccel_x_m_per_s2\n1\n"),
            "r.csv:2:19: error: sample_rate_hz is 1e-300 (expected a number of 1e-15 or more)");
  EXPECT_EQ(ErrorOf("# kind: vibration\n# sample_rate_hz: 100\nmic_Pa\n1\n1e31\n"),
            "r.csv:5:1: error: mic_Pa is 1e+31 (expected a number from -1e+30 to 1e+30)");
}

TEST(CsvLimits, RefusesTimeThatHardlyGoesOn) {
  EXPECT_EQ(ErrorOf("# kind: vibration\ntime_s,accel_x_m_per_s2\n0,1\n1e-300,2\n2e-300,3\n"),
            "r.csv:5:1: error: time_s goes on by 1e-300 s a row (expected 1e-09 s or more)");
}

TEST(CsvLimits, HasLimitsOfColumnsMetadataAndLines) {
  const auto repeated = [](std::string_view text, std::size_t times) {
    std::string all;
    for (std::size_t i = 0; i < times; ++i) all += fmt::format("{}{}", text, i);
    return all;
  };
  EXPECT_EQ(
      ErrorOf("# kind: vibration\n# sample_rate_hz: 1\na_V" + repeated(",c", 10'000) + "\n1\n"),
      "r.csv:3:58889: error: the header has 10001 columns (expected at most 10000: a record a part of the "
      "channels)");
  EXPECT_EQ(ErrorOf("# kind: vibration" + repeated(":\n# k", 10'000) + ": 1\na_V\n1\n").substr(0, 120),
            "r.csv:10001:1: error: there are more than 10000 lines of metadata (expected fewer, and values "
            "in columns)");
  const std::string long_line(std::size_t{1} << 21, ',');
  EXPECT_EQ(ErrorOf(kLoop + long_line + "\n"),
            "r.csv:7:1048577: error: the line has 2097152 bytes (expected lines of at most 1048576)");
}

// A million of them would otherwise be kept, each with its text.
TEST(CsvLimits, StopsAtAThousandFindings) {
  std::string text = kLoop;
  for (int i = 0; i < 100'000; ++i) text += "1\n";
  try {
    ParseCsvRecord(text, "r.csv");
    FAIL();
  } catch (const RecordError& error) {
    EXPECT_EQ(error.findings().size(), 1000U);
  }
}

// One row and 20 million blank lines: memory for as many rows as the text can hold, and no more.
TEST(CsvLimits, TakesNoMemoryForBlankLines) {
  std::string header = "# kind: vibration\n# sample_rate_hz: 1\nc0_V", row = "0";
  for (int i = 1; i < 10'000; ++i) {
    header += fmt::format(",c{}_V", i);
    row += ",1";
  }
  const Record record = ParseCsvRecord(header + "\n" + row + "\n" + std::string(20'000'000, '\n'), "r.csv");
  EXPECT_EQ(record.rows(), 1U);
  EXPECT_EQ(record.columns.size(), 10'000U);
}

}  // namespace
}  // namespace strainwave::daq::csv_limits_test
