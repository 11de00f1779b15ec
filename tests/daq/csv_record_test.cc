// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "daq/value_bounds.h"
#include "tests/daq/csv_sample.h"

namespace strainwave::daq::csv_record_test {
namespace {

TEST(CsvRecord, ReadsMetadataAndColumns) {
  const Record record = ParseCsvRecord(kLoop, "r.csv");
  EXPECT_EQ(record.kind, RecordKind::kHysteresis);
  EXPECT_EQ(record.metadata, (std::vector<std::pair<std::string, std::string>>{{"t1_Nm", "7"}}));
  ASSERT_EQ(record.rows(), 3U);
  EXPECT_EQ(record.Doubles("torque_Nm")[1], -2.5);
  EXPECT_EQ(record.source.file, "r.csv");
  EXPECT_EQ(record.source.first_data_line, 4);
  EXPECT_TRUE(record.notes.empty());
}

TEST(CsvRecord, ReadsBothDirectionsOfASweepInAnyColumnOrder) {
  const Record record = ParseCsvRecord(
      "# kind: transmission_error\noutput_angle_deg,direction,input_angle_deg\n1,cw,80\n1,ccw,80.5\n",
      "r.csv");
  EXPECT_EQ(record.Directions("direction")[0], Direction::kClockwise);
  EXPECT_EQ(record.Directions("direction")[1], Direction::kCounterClockwise);
  EXPECT_EQ(record.Doubles("input_angle_deg")[1], 80.5);
  EXPECT_EQ(record.columns.front().name, "output_angle_deg");
}

TEST(CsvRecord, ReadsTheWordsForDirectionsThatOthersUse) {
  for (const auto& [cw, ccw] : {std::pair("cw", "ccw"),
                                {"CW", "CCW"},
                                {"forward", "backward"},
                                {"1", "-1"},
                                {"+1", "-1.0"},
                                {"Positive", "negative"}}) {
    const std::string rows = fmt::format("{},0,1\n{},80,2\n{},81,3\n", cw, ccw, cw);
    const Record record = ParseCsvRecord(
        "# kind: transmission_error\ndirection,input_angle_deg,output_angle_deg\n" + rows, "r.csv");
    EXPECT_EQ(record.Directions("direction")[0], Direction::kClockwise) << cw;
    EXPECT_EQ(record.Directions("direction")[1], Direction::kCounterClockwise) << ccw;
    EXPECT_EQ(record.Directions("direction")[2], Direction::kClockwise) << cw;
  }
}

TEST(CsvRecord, ReadsMotionOfARotaryAndOfALinearAxis) {
  const Record rotary = ParseCsvRecord("# kind: motion\ntime_s,position_rad,torque_Nm\n0,1,2\n", "r.csv");
  EXPECT_FALSE(IsLinearAxis(rotary));
  const Record linear = ParseCsvRecord(
      "# kind: motion\n# mass_kg: 12\ntime_s,position_m,force_N,velocity_m_per_s\n0,1,2,3\n", "r.csv");
  EXPECT_TRUE(IsLinearAxis(linear));
}

TEST(CsvRecord, ReadsAVibrationBySampleRateWithAnyChannel) {
  const Record record =
      ParseCsvRecord("# kind: vibration\n# sample_rate_hz: 25600\nmic_Pa,accel_x_m_per_s2\n1,2\n", "r.csv");
  EXPECT_EQ(record.Doubles("mic_Pa")[0], 1.0);
  EXPECT_EQ(MetadataNumber(record, "sample_rate_hz"), 25600.0);
}

TEST(CsvRecord, ToleratesWhatSpreadsheetsWrite) {
  const Record record = ParseCsvRecord(
      "\xEF\xBB\xBF#kind:hysteresis\r\n#\r\n# note: 20 °C\r\n\r\n\"time_s\", torque_Nm ,output_angle_deg\r\n"
      "0,+1.5,\t1e-2\r\n0.1, -2.5 ,\"0.02\"\r\n\r\n  \r\n",
      "r.csv");
  EXPECT_EQ(record.rows(), 2U);
  EXPECT_EQ(record.Doubles("torque_Nm")[0], 1.5);
  EXPECT_EQ(record.Doubles("output_angle_deg")[1], 0.02);
  EXPECT_EQ(record.Metadata("note"), "20 °C");
}

TEST(CsvRecord, ReadsALastLineWithoutALineEnd) {
  EXPECT_EQ(ParseCsvRecord(kLoop.substr(0, kLoop.size() - 1), "r.csv").rows(), 3U);
}

TEST(CsvRecord, KeepsUnknownColumnsOfNumbersAndNotesThoseOfText) {
  const Record record = ParseCsvRecord(
      "# kind: hysteresis\ntime_s,torque_Nm,output_angle_deg,humidity,remark,gap\n"
      "0,1,2,40.5,\"cold, wet\",\n1,1,2,nan,ok,3\n",
      "r.csv");
  EXPECT_EQ(record.Doubles("humidity")[0], 40.5);
  EXPECT_TRUE(std::isnan(record.Doubles("humidity")[1]));
  EXPECT_EQ(record.FindColumn("remark"), nullptr);
  EXPECT_EQ(record.notes, (std::vector<RecordNote>{{3, "column 'remark' is left out: line 3 is not a number"},
                                                   {3, "column 'gap' is left out: line 3 is not a number"}}));
}

TEST(CsvRecord, GivesTheDefaultsOfTheContract) {  // docs/contract.md#record-files
  const Record loop = ParseCsvRecord(kLoop, "r.csv");
  EXPECT_EQ(MetadataNumber(loop, "t1_Nm"), 7.0);
  EXPECT_EQ(MetadataNumber(loop, "t2_Nm"), 25.0);
  EXPECT_EQ(MetadataNumber(loop, "t3_Nm"), 34.0);
  EXPECT_EQ(MetadataNumber(loop, "ratio"), 80.0);
  EXPECT_EQ(MetadataNumber(loop, "inertia_kgm2"), std::nullopt);
}

// One bad thing each: text, message.
struct BadText {
  const char* name;
  std::string text;
  std::string message;
};

class BadCsv : public testing::TestWithParam<BadText> {};

TEST_P(BadCsv, IsRefusedWithLineAndColumn) { EXPECT_EQ(ErrorOf(GetParam().text), GetParam().message); }

const std::string kNeedsLoopColumns =
    "(expected the columns time_s, torque_Nm, output_angle_deg in a hysteresis record)";
const std::string kKinds = "transmission_error, hysteresis, motion, vibration, motor, joints or history)";
const std::string kSweep = "# kind: transmission_error\ndirection,input_angle_deg,output_angle_deg\n";

INSTANTIATE_TEST_SUITE_P(
    EachRule, BadCsv,
    testing::Values(
        BadText{"MissingColumn", Replaced(kLoop, "torque_Nm", "torque"),
                "r.csv:3:1: error: column 'torque_Nm' is missing " + kNeedsLoopColumns},
        BadText{"DoubledColumn", Replaced(kLoop, "output_angle_deg", "torque_Nm"),
                "r.csv:3:18: error: column 'torque_Nm' is doubled (expected each column once)"},
        BadText{"NamelessColumn", Replaced(kLoop, "torque_Nm,", ","),
                "r.csv:3:8: error: column 2 has no name (expected a name such as torque_Nm)"},
        BadText{"NoNumber", Replaced(kLoop, "-2.5", "2.5 Nm"),
                "r.csv:5:5: error: torque_Nm is '2.5 Nm' (expected a number)"},
        BadText{"DecimalComma", Replaced(kLoop, "-2.5", "2,5"),
                "r.csv:5:9: error: the line has 4 cells (expected 3, as in the header)"},
        BadText{"EmptyCell", Replaced(kLoop, "-2.5", ""),
                "r.csv:5:5: error: torque_Nm is empty (expected a number)"},
        BadText{"TooLarge", Replaced(kLoop, "-2.5", "1e999"),
                "r.csv:5:5: error: torque_Nm is '1e999' (expected a number)"},
        BadText{"NotANumberValue", Replaced(kLoop, "-2.5", "NaN"),
                "r.csv:5:5: error: torque_Nm is nan (expected a finite number)"},
        BadText{"Infinite", Replaced(kLoop, "-2.5", "-inf"),
                "r.csv:5:5: error: torque_Nm is -inf (expected a finite number)"},
        BadText{
            "TimeBackwards", Replaced(kLoop, "0.2,", "0.05,"),
            "r.csv:6:1: error: time_s runs backwards from 0.1 to 0.05 (expected time that never decreases)"},
        BadText{"RatioOfZero", "# kind: transmission_error\n#  ratio: 0.0\n" + kSweep.substr(27) + "cw,1,2\n",
                "r.csv:2:11: error: ratio is 0.0 (expected a number other than zero)"},
        BadText{"MissingKind", Replaced(kLoop, "# kind: hysteresis\n", ""),
                "r.csv:1:1: error: metadata 'kind' is missing (expected '# kind: ' and " + kKinds},
        BadText{"UnknownKind", Replaced(kLoop, "hysteresis", "hysterese"),
                "r.csv:1:9: error: kind is 'hysterese' (expected " + kKinds},
        BadText{"EmptyKind", Replaced(kLoop, " hysteresis", ""),
                "r.csv:1:8: error: kind is '' (expected " + kKinds},
        BadText{"RaggedRow", Replaced(kLoop, "-2.5,", ""),
                "r.csv:5:9: error: the line has 2 cells (expected 3, as in the header)"},
        BadText{"OneCell", Replaced(kLoop, "0.1,-2.5,0.02", "17"),
                "r.csv:5:3: error: the line has 1 cell (expected 3, as in the header)"},
        BadText{"BlankLineBetween", Replaced(kLoop, "0.1,", "\n0.1,"),
                "r.csv:5:1: error: the line is blank (expected 3 cells, as in the header)"},
        BadText{"EmptyFile", "",
                "r.csv:1:1: error: the file is empty (expected lines '# key: value', a header line, and "
                "numbers)"},
        BadText{"HeaderOnly", kLoop.substr(0, kLoop.find("0,1.5")),
                "r.csv:4:1: error: no rows follow the header (expected at least one line of numbers)"},
        BadText{
            "MetadataOnly", "# kind: hysteresis\n",
            "r.csv:2:1: error: the header line is missing (expected the names of the columns, with commas "
            "between)"},
        BadText{
            "Direction", kSweep + "cw,1,2\nclockwise,1,2\n",
            "r.csv:4:1: error: direction is 'clockwise' (expected cw or ccw, forward or backward, 1 or -1)"},
        BadText{"DirectionThatIsNoNumberOfOne", kSweep + "2,1,2\n",
                "r.csv:3:1: error: direction is '2' (expected cw or ccw, forward or backward, 1 or -1)"},
        BadText{"KneesOutOfOrder", Replaced(kLoop, "t1_Nm: 7", "t1_Nm: 26"),
                "r.csv:2:10: error: t1_Nm = 26 is not below t2_Nm = 25 (expected 0 < t1_Nm < t2_Nm < t3_Nm)"},
        BadText{"PeakBelowKnee", Replaced(kLoop, "t1_Nm: 7", "t3_Nm: 20"),
                "r.csv:2:10: error: t2_Nm = 25 is not below t3_Nm = 20 (expected 0 < t1_Nm < t2_Nm < t3_Nm)"},
        BadText{"NegativeKnee", Replaced(kLoop, "t1_Nm: 7", "t1_Nm: -7"),
                "r.csv:2:10: error: t1_Nm is -7 (expected a number above zero)"},
        BadText{"MetadataNoNumber", Replaced(kLoop, "t1_Nm: 7", "t1_Nm: 7 Nm"),
                "r.csv:2:10: error: t1_Nm is '7 Nm' (expected a number)"},
        BadText{"MetadataNan", Replaced(kLoop, "t1_Nm: 7", "t1_Nm: nan"),
                "r.csv:2:10: error: t1_Nm is nan (expected a number above zero)"},
        BadText{"MetadataEmpty", Replaced(kLoop, "t1_Nm: 7", "t1_Nm:"),
                "r.csv:2:9: error: t1_Nm is '' (expected a number)"},
        BadText{"MetadataDoubled", Replaced(kLoop, "# t1_Nm: 7\n", "# t1_Nm: 7\n# t1_Nm: 8\n"),
                "r.csv:3:3: error: metadata 't1_Nm' is doubled (expected it once, as in line 2)"},
        BadText{"MetadataWithoutColon", Replaced(kLoop, "t1_Nm: 7", "t1_Nm 7"),
                "r.csv:2:3: error: 't1_Nm 7' is not metadata (expected '# key: value')"},
        BadText{
            "MetadataAfterHeader", Replaced(kLoop, "0.1,-2.5,0.02", "# t2_Nm: 20"),
            "r.csv:5:1: error: metadata after the header line (expected metadata before the header line)"},
        BadText{"AbsoluteNotBoolean", Replaced(kLoop, "t1_Nm: 7", "absolute: yes"),
                "r.csv:2:13: error: absolute is 'yes' (expected true or false)"},
        BadText{"CutInTheLine", kLoop.substr(0, kLoop.size() - 6),
                "r.csv:6:6: error: the last line is cut off after 2 of 3 cells (expected a whole line)"},
        BadText{"CutAfterAComma", kLoop.substr(0, kLoop.size() - 5),
                "r.csv:6:7: error: the last line is cut off after 2 of 3 cells (expected a whole line)"},
        BadText{"CutInANumber", kLoop.substr(0, kLoop.size() - 5) + "1e-",
                "r.csv:6:7: error: output_angle_deg is '1e-' (expected a number)"},
        BadText{"NoTimeOfVibration", "# kind: vibration\naccel_x_m_per_s2\n1\n",
                "r.csv:2:1: error: neither column 'time_s' nor metadata 'sample_rate_hz' is there (expected "
                "one of "
                "them in a vibration record)"},
        BadText{"NoChannelOfVibration", "# kind: vibration\ntime_s\n1\n",
                "r.csv:2:1: error: no channel is there (expected at least one column such as "
                "accel_x_m_per_s2 in a "
                "vibration record)"},
        BadText{"BadFurtherChannel", "# kind: vibration\ntime_s,mic_Pa\n1,2\n2,x\n",
                "r.csv:4:3: error: mic_Pa is 'x' (expected a number)"},
        BadText{"NanInFurtherChannel", "# kind: vibration\ntime_s,mic_Pa\n1,2\n2,nan\n",
                "r.csv:4:3: error: mic_Pa is nan (expected a finite number)"},
        BadText{"SampleRateOfZero", "# kind: vibration\n# sample_rate_hz: 0\nmic_Pa\n1\n",
                "r.csv:2:19: error: sample_rate_hz is 0 (expected a number above zero)"},
        BadText{"HalfALinearAxis", "# kind: motion\ntime_s,position_m\n0,1\n",
                "r.csv:2:1: error: column 'force_N' is missing (expected the columns time_s, position_rad, "
                "torque_Nm "
                "in a motion record, or time_s, position_m, force_N for a linear axis)"},
        BadText{"BinaryJunk", std::string("# kind: hysteresis\nab\0c", 23),
                "r.csv:2:3: error: byte 0x00 is not text (expected a record as CSV in UTF-8, or as HDF5)"},
        BadText{"NotUtf8", "# kind: hysteresis\n# by: M\xFCller\n",
                "r.csv:2:8: error: byte 0xFC is not text (expected a record as CSV in UTF-8, or as HDF5)"}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(CsvRecord, LeavesOutTheLineThatALoggerWasKilledIn) {
  const std::string log = "# kind: motion\ntime_s,position_rad,torque_Nm\n0,1,2\n0.1,1,2\n";
  for (const char* cut : {"0.2", "0.2,", "0.2,1", "0.2,1,", "0.2,1,-", "0.2,1,1e-"}) {
    const Record record = ParseCsvRecord(log + cut, "r.csv");
    EXPECT_EQ(record.rows(), 2U) << cut;
    EXPECT_EQ(record.notes, (std::vector<RecordNote>{{5, "line 5 is left out: it is cut off"}})) << cut;
  }
  EXPECT_EQ(ParseCsvRecord(log + "0.2,1,2", "r.csv").rows(), 3U);
  EXPECT_EQ(ErrorOf(log + "0.2,1\n"),
            "r.csv:5:6: error: the line has 2 cells (expected 3, as in the header)");
  EXPECT_EQ(ErrorOf(log + "0.2,1,2,3"),
            "r.csv:5:9: error: the line has 4 cells (expected 3, as in the header)");
}

TEST(CsvRecord, ReportsEverythingAtOnceInTheOrderOfLines) {
  EXPECT_EQ(ErrorOf("# kind: hysteresis\n# t1_Nm: x\ntime_s,torque_Nm\n0,1\n2,abc\n1,inf\n"),
            "r.csv:2:10: error: t1_Nm is 'x' (expected a number)\n"
            "r.csv:3:1: error: column 'output_angle_deg' is missing " +
                kNeedsLoopColumns +
                "\n"
                "r.csv:5:3: error: torque_Nm is 'abc' (expected a number)\n"
                "r.csv:6:1: error: time_s runs backwards from 2 to 1 (expected time that never decreases)\n"
                "r.csv:6:3: error: torque_Nm is inf (expected a finite number)");
}

TEST(CsvRecord, CountsWhatItDoesNotShow) {
  std::string text = "# kind: hysteresis\ntime_s,torque_Nm,output_angle_deg\n";
  for (int i = 0; i < 30; ++i) text += "0,x,0\n";
  const std::string message = ErrorOf(text);
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 20);
  EXPECT_TRUE(
      message.ends_with("r.csv:22:3: error: torque_Nm is 'x' (expected a number)\nand 10 more errors"))
      << message;
}

// Each cut of a good file is either refused with a line, or reads as the lines that are whole.
TEST(CsvRecord, NeverInventsRowsWhenCutAnywhere) {
  const Record whole = ParseCsvRecord(kLoop, "r.csv");
  for (std::size_t length = 0; length < kLoop.size(); ++length) {
    try {
      const Record cut = ParseCsvRecord(std::string_view(kLoop).substr(0, length), "r.csv");
      ASSERT_LE(cut.rows(), whole.rows());
      for (std::size_t row = 0; row + 1 < cut.rows(); ++row) {
        EXPECT_EQ(cut.Doubles("output_angle_deg")[row], whole.Doubles("output_angle_deg")[row]);
      }
    } catch (const RecordError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("r.csv:")) << error.what();
    }
  }
}

TEST(CsvRecord, SurvivesEverySingleByteChanged) {
  std::size_t read = 0;
  std::size_t refused = 0;
  for (std::size_t at = 0; at < kLoop.size(); ++at) {
    for (const int byte : {0, 10, 13, 34, 35, 44, 46, 58, 45, 101, 128, 255}) {
      std::string text = kLoop;
      text[at] = static_cast<char>(byte);
      try {
        ParseCsvRecord(text, "r.csv");
        ++read;
      } catch (const RecordError&) {
        ++refused;
      }
    }
  }
  // A digit for another is a record, a NUL is none anywhere.
  EXPECT_GT(read, 0U);
  EXPECT_GE(refused, kLoop.size());
}

TEST(ReadCsvRecord, NamesAFileThatIsMissingOrAFolder) {
  const ScratchFolder folder;
  const std::string missing = (folder / "none.csv").string();
  EXPECT_EQ(MessageOf<RecordError>([&] { ReadCsvRecord(missing); }),
            missing + ": error: No such file or directory (expected a record file)");
  EXPECT_EQ(MessageOf<RecordError>([&] { ReadCsvRecord(folder.path()); }),
            folder.path().string() + ": error: Is a directory (expected a record file)");
  EXPECT_EQ(MessageOf<RecordError>([&] { ReadCsvRecord("/dev/zero"); }),
            "/dev/zero: error: is a device (expected a record file)");
}

Record RandomSweep(std::size_t rows) {
  std::mt19937_64 random(7);
  Record record;
  record.kind = RecordKind::kTransmissionError;
  record.SetMetadata("ratio", -80.5);
  record.SetMetadata("specimen", "A: 3, \"left\"");
  record.SetMetadata("remark", "");
  std::vector<Direction> directions(rows, Direction::kClockwise);
  directions.back() = Direction::kCounterClockwise;
  std::vector<double> input, output;
  std::vector<float> extra;
  for (std::size_t i = 0; i < rows; ++i) {
    // Any bits that are a number which an angle can be.
    const auto draw = [&random] {
      while (true) {
        const double value = std::bit_cast<double>(random());
        if (BoundsOf("input_angle_deg").Hold(value)) return value;
      }
    };
    input.push_back(draw());
    output.push_back(draw());
    extra.push_back(static_cast<float>(i) / 3.0F);
  }
  record.columns.push_back({"direction", directions, "", ""});
  record.columns.push_back({"input_angle_deg", input, "", ""});
  record.columns.push_back({"output_angle_deg", output, "", ""});
  record.columns.push_back({"extra_x", extra, "", ""});
  return record;
}

TEST(WriteCsvRecord, ReadsBackToTheSameBits) {
  const ScratchFolder folder;
  const Record written = RandomSweep(500);
  WriteCsvRecord(written, folder / "r.csv");
  const Record read = ReadCsvRecord(folder / "r.csv");
  EXPECT_EQ(read.kind, written.kind);
  EXPECT_EQ(read.metadata, written.metadata);
  ASSERT_EQ(read.columns.size(), 4U);
  EXPECT_EQ(read.columns[0].values, written.columns[0].values);
  for (const char* name : {"input_angle_deg", "output_angle_deg"}) {
    for (std::size_t i = 0; i < written.rows(); ++i) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(read.Doubles(name)[i]),
                std::bit_cast<std::uint64_t>(written.Doubles(name)[i]));
    }
  }
  // A float comes back as the double of its shortest text, which is the same float.
  for (std::size_t i = 0; i < written.rows(); ++i) {
    ASSERT_EQ(static_cast<float>(read.Doubles("extra_x")[i]),
              std::get<std::vector<float>>(written.columns[3].values)[i]);
  }
}

TEST(WriteCsvRecord, RefusesWhatWouldReadBackAsSomethingElse) {
  using Error = std::invalid_argument;
  const auto message_with = [](auto change) {
    Record record = RandomSweep(2);
    change(record);
    return MessageOf<Error>([&] { CsvTextOf(record); });
  };
  EXPECT_EQ(message_with([](Record& r) { r.SetMetadata("a:b", "x"); }),
            "metadata key 'a:b' cannot stand in a CSV record");
  EXPECT_EQ(message_with([](Record& r) { r.SetMetadata("note", "two\nlines"); }),
            "metadata value 'two\nlines' cannot stand in a CSV record");
  EXPECT_EQ(message_with([](Record& r) { r.SetMetadata("kind", "x"); }),
            "metadata key 'kind' is empty, doubled or 'kind'");
  EXPECT_EQ(message_with([](Record& r) { r.columns[3].name = "a,b"; }),
            "column name 'a,b' cannot stand in a CSV record");
  EXPECT_EQ(message_with([](Record& r) { r.columns[3].name = "direction"; }),
            "column name 'direction' is empty, doubled or a comment");
  EXPECT_EQ(message_with([](Record& r) { r.columns[3].values = std::vector{1.0}; }),
            "column 'extra_x' has 1 rows, not 2");
  EXPECT_EQ(message_with([](Record& r) { r.columns.clear(); }), "the record has no rows");
}

TEST(CsvRecord, ReadsLargeFilesWhole) {
  std::string text = "# kind: hysteresis\ntime_s,torque_Nm,output_angle_deg,temperature_degC\n";
  constexpr int kRows = 100000;
  for (int i = 0; i < kRows; ++i) {
    text += std::to_string(i) + ".001," + std::to_string(i % 34) + ".123456,-0.0" + std::to_string(i) +
            ",31.25\n";
  }
  const auto start = std::chrono::steady_clock::now();
  const Record record = ParseCsvRecord(text, "r.csv");
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  RecordProperty("milliseconds", std::to_string(took.count()));
  ASSERT_EQ(record.rows(), static_cast<std::size_t>(kRows));
  EXPECT_EQ(record.Doubles("time_s").back(), 99999.001);
}

}  // namespace
}  // namespace strainwave::daq::csv_record_test
