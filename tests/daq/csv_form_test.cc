// SPDX-License-Identifier: Apache-2.0
// One loop in the forms that spreadsheets, NumPy and loggers write.
#include "daq/csv_form.h"

#include "tests/daq/csv_sample.h"

namespace strainwave::daq::csv_form_test {
namespace {

const std::string kHead = "# kind: hysteresis\n# t1_Nm: 7\n";

// Three rows of time, torque and angle: 0, 1.5, 0.01; 0.1, -2.5, 0.02; 0.2, 3, 0.0325.
void ExpectTheLoop(const std::string& text) {
  SCOPED_TRACE(text);
  const Record record = ParseCsvRecord(text, "r.csv");
  EXPECT_EQ(record.kind, RecordKind::kHysteresis);
  EXPECT_EQ(record.Metadata("t1_Nm"), "7");
  const auto values = [&](const char* name) {
    const auto column = record.Doubles(name);
    return std::vector<double>(column.begin(), column.end());
  };
  EXPECT_EQ(values("time_s"), (std::vector{0.0, 0.1, 0.2}));
  EXPECT_EQ(values("torque_Nm"), (std::vector{1.5, -2.5, 3.0}));
  EXPECT_EQ(values("output_angle_deg"), (std::vector{0.01, 0.02, 0.0325}));
}

TEST(CsvForm, SeparatorsAreToldFromTheHeader) {
  ExpectTheLoop(kHead + "time_s;torque_Nm;output_angle_deg\n0;1.5;0.01\n0.1;-2.5;0.02\n0.2;3;0.0325\n");
  ExpectTheLoop(kHead +
                "time_s\ttorque_Nm\toutput_angle_deg\n0\t1.5\t0.01\n0.1\t-2.5\t0.02\n0.2\t3\t0.0325\n");
  ExpectTheLoop(kHead +
                "time_s | torque_Nm | output_angle_deg\n0 | 1.5 | 0.01\n0.1|-2.5|0.02\n0.2|3|0.0325\n");
  ExpectTheLoop(
      kHead +
      "time_s  torque_Nm  output_angle_deg\n  0     1.5    0.01\n  0.1  -2.5    0.02 \n0.2 3\t0.0325\n");
}

TEST(CsvForm, DecimalCommasAreRead) {
  const std::string rows = "0,0;1,5;0,01\n0,1;-2,5;0,02\n0,2;3;0,0325\n";
  ExpectTheLoop(kHead + "time_s;torque_Nm;output_angle_deg\n" + rows);
  ExpectTheLoop(
      "# kind: hysteresis\r\n# t1_Nm: "
      "7\r\ntime_s\ttorque_Nm\toutput_angle_deg\r\n0\t1,50\t1,0e-2\r\n0,1\t-2,5\t0,02"
      "\r\n0,2\t+3\t0,0325\r\n");
  ExpectTheLoop(kHead +
                "time_s,torque_Nm,output_angle_deg\n\"0,0\",\"1,5\",\"0,01\"\n\"0,1\",\"-2,5\",\"0,02\"\n\"0,"
                "2\",3,\"0,0325\"\n");
  EXPECT_EQ(
      ParseCsvRecord("# kind: hysteresis\n# t1_Nm: 7,25\ntime_s;torque_Nm;output_angle_deg\n" + rows, "r.csv")
          .Metadata("t1_Nm"),
      "7.25");
}

TEST(CsvForm, ALineThatNamesTheSeparatorIsTaken) {
  const std::string rows = "time_s;torque_Nm;output_angle_deg\n0,0;1,5;0,01\n0,1;-2,5;0,02\n0,2;3;0,0325\n";
  ExpectTheLoop("\xEF\xBB\xBFsep=;\r\n" + kHead + rows);
  ExpectTheLoop("\"SEP=;\"\n" + kHead + rows);
  EXPECT_EQ(ErrorOf("sep=,\n" + kHead + rows),
            "r.csv:1:1: error: 'sep=' says commas, the header has semicolons (expected the same)");
  EXPECT_EQ(ErrorOf("sep=ab\n" + kHead + rows),
            "r.csv:1:1: error: 'sep=ab' names no separator (expected a comma, a semicolon, a tab, a bar or a "
            "blank after "
            "'sep=')");
}

TEST(CsvForm, AHeaderBehindASignIsTaken) {
  ExpectTheLoop(kHead + "# time_s,torque_Nm,output_angle_deg\n0,1.5,0.01\n0.1,-2.5,0.02\n0.2,3,0.0325\n");
  ExpectTheLoop(
      kHead +
      "#time_s torque_Nm output_angle_deg\n0.00e+00 1.5e+00 1e-02\n1.0e-01 -2.5e+00 2e-02\n0.2 3 0.0325\n");
  const std::string missing =
      "r.csv:4:1: error: the header line is missing (expected the names of the columns, with commas between)";
  EXPECT_EQ(ErrorOf(kHead + "# a remark\n0,1.5,0.01\n"), missing);
  EXPECT_EQ(ErrorOf(kHead + "# by: a logger\n0;1,5;0,01\n"), missing);
}

TEST(CsvForm, LinesThatASpreadsheetFilledUpOrQuotedAreMetadata) {
  ExpectTheLoop(
      "# kind: hysteresis;;\n# t1_Nm: 7;;\n;;\n\"# note: a; "
      "b\";;\ntime_s;torque_Nm;output_angle_deg\n0;1.5;0.01\n"
      "0.1;-2.5;0.02\n0.2;3;0.0325\n");
  ExpectTheLoop(
      "# kind: hysteresis,,\n# t1_Nm: "
      "7,,\ntime_s,torque_Nm,output_angle_deg\n0,1.5,0.01\n0.1,-2.5,0.02\n0.2,3,0.0325\n");
  EXPECT_EQ(ParseCsvRecord(Replaced(kLoop, "t1_Nm: 7", "note: a, b,"), "r.csv").Metadata("note"), "a, b,");
}

TEST(CsvForm, TheSpacesOfWebPagesAreBlanks) {
  EXPECT_EQ(ParseCsvRecord(Replaced(kLoop, ": 7", ":\u00A07\u202F"), "r.csv").Metadata("t1_Nm"), "7");
  EXPECT_EQ(ParseCsvRecord(Replaced(kLoop, "-2.5", "\u00A0-2.5"), "r.csv").Doubles("torque_Nm")[1], -2.5);
}

TEST(CsvForm, WhatCanBeReadInTwoWaysIsRefusedWithTheCause) {
  const std::string head = kHead + "time_s;torque_Nm;output_angle_deg\n";
  EXPECT_EQ(ErrorOf(kHead + "time_s,torque_Nm,output_angle_deg\n0,00,1,50,0,01\n0,10,-2,5,0,02\n"),
            "r.csv:4:1: error: the numbers have a decimal comma, and the cells a comma between (expected "
            "decimal points, or "
            "semicolons between the cells)");
  EXPECT_EQ(ErrorOf(head + "0;1,5;0.01\n"),
            "r.csv:4:3: error: '1,5' has a decimal comma, '0.01' in line 4 a point (expected one of them in "
            "a file, and "
            "nothing between thousands)");
  EXPECT_EQ(ErrorOf(head + "0;1,500;2\n1;1,501;3\n"),
            "r.csv:4:3: error: '1,500' can be a decimal comma, or a comma between thousands (expected a "
            "decimal point, and "
            "nothing between thousands)");
  EXPECT_EQ(
      ErrorOf(kHead + "time_s,torque_Nm,output_angle_deg\n0 1.5 0.01\n"),
      "r.csv:4:1: error: the cells have blanks between, the names in the header commas (expected the same)");
}

TEST(CsvForm, ALineThatIsTooLongIsNotTakenToPieces) {
  EXPECT_EQ(ErrorOf(kHead + "a" + std::string(std::size_t{1} << 21, ';') + "b\n"),
            "r.csv:3:1048577: error: the line has 2097154 bytes (expected lines of at most 1048576)");
}

TEST(CsvForm, MessagesCountColumnsAsTheFileHasThem) {
  EXPECT_EQ(ErrorOf("sep=;\n" + kHead + "time_s;torque_Nm;output_angle_deg\n0,0;1,5;0,01\n0,1;x;0,02\n"),
            "r.csv:6:5: error: torque_Nm is 'x' (expected a number)");
  EXPECT_EQ(ErrorOf("\xFF\xFEt\0i\0"),
            "r.csv:1:1: error: the text is UTF-16 (expected a record as CSV in UTF-8, or as HDF5)");
}

}  // namespace
}  // namespace strainwave::daq::csv_form_test
