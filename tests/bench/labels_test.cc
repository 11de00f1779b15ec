// SPDX-License-Identifier: Apache-2.0
#include "bench/data_sets/labels.h"

#include <string>

#include <gtest/gtest.h>

#include "bench/errors/bench_error.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::labels_test {
namespace {

class LabelsFile : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder_ / "set");
    for (const char* name : {"set/a.csv", "set/b.csv", "set/c d.csv", "outside.csv"})
      daq::WriteBytes(folder_ / name, "x\n");
  }
  Labels Read(const std::string& text) const {
    daq::WriteBytes(folder_ / "set/labels.csv", text);
    return ReadLabels(folder_ / "set");
  }
  // What is refused, without the folder's name.
  std::string MessageOf(const std::string& text) const {
    try {
      Read(text);
    } catch (const BenchError& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::kWrongInput);
      return Plain(error);
    }
    return "";
  }
  std::string Plain(const BenchError& error) const {
    std::string what = error.what();
    const std::string prefix = folder_.path().string() + "/";
    for (std::size_t at; (at = what.find(prefix)) != what.npos;) what.erase(at, prefix.size());
    return what;
  }
  daq::ScratchFolder folder_;
};

TEST_F(LabelsFile, KeepsEveryColumnAndTheOrderOfRows) {
  const Labels labels =
      Read("health_hd,unit,file,health_tb,speed\n0.5,u1,b.csv,0,fast\n1,u2,\"c d.csv\",0.25,slow\n");
  ASSERT_EQ(labels.rows().size(), 2U);
  EXPECT_EQ(labels.rows()[0].file, folder_ / "set/b.csv");
  EXPECT_EQ(labels.rows()[1].name, "c d.csv");
  EXPECT_EQ(labels.Units(), (std::vector<std::string>{"u1", "u2"}));
  EXPECT_EQ(labels.WithPrefix("health_"), (std::vector<std::string>{"hd", "tb"}));
  EXPECT_EQ(labels.Numbers("health_hd", 0.0, 1.0), (std::vector<double>{0.5, 1.0}));
  EXPECT_EQ(labels.Texts("speed"), (std::vector<std::string>{"fast", "slow"}));
  EXPECT_EQ(labels.columns(), (std::vector<std::string>{"health_hd", "health_tb", "speed"}));
  EXPECT_TRUE(labels.Has("speed"));
  EXPECT_FALSE(labels.Has("class"));
}

TEST_F(LabelsFile, TakesTheByteOrderMarkAndLineEndsOfSpreadsheets) {
  const Labels labels =
      Read("\xEF\xBB\xBF# made by hand\r\nfile,unit,class\r\na.csv,u1,worn\r\n\r\nb.csv,u2,sound\r\n");
  EXPECT_EQ(labels.Texts("class"), (std::vector<std::string>{"worn", "sound"}));
  EXPECT_EQ(labels.rows()[1].line, 5);
}

TEST_F(LabelsFile, RefusesATableThatIsNone) {
  EXPECT_EQ(MessageOf(""),
            "set/labels.csv:1:1: error: has no header (expected a header such as file,unit,class)");
  EXPECT_EQ(MessageOf("file,unit\n"),
            "set/labels.csv:1:1: error: has no rows (expected a row for each record)");
  EXPECT_EQ(
      MessageOf("file,class\na.csv,worn\n"),
      "set/labels.csv:1:1: error: column 'unit' is missing (expected a header such as file,unit,class)");
  EXPECT_EQ(MessageOf("file,unit,class,class\n"),
            "set/labels.csv:1:17: error: column 'class' is there twice (expected each column once)");
  EXPECT_EQ(MessageOf("file,unit,\n"),
            "set/labels.csv:1:11: error: a column has no name (expected a header such as file,unit,class)");
  EXPECT_EQ(MessageOf("file,unit\na.csv,u1,worn\n"),
            "set/labels.csv:2:1: error: 3 cells (expected 2: file, unit)");
  EXPECT_EQ(MessageOf("file,unit\na.csv,\xFF\n"),
            "set/labels.csv:2: error: is no UTF-8 text (expected a CSV file with commas)");
}

TEST_F(LabelsFile, RefusesFilesThatAreNotThereOrTwice) {
  EXPECT_EQ(MessageOf("file,unit\nz.csv,u1\n"),
            "set/labels.csv:2:1: error: 'z.csv' names no file (expected a record below the folder)");
  EXPECT_EQ(MessageOf("file,unit\na.csv,u1\n./a.csv,u2\n"),
            "set/labels.csv:3:1: error: './a.csv' is there twice, in line 2 too (expected each file once)");
  EXPECT_EQ(MessageOf("file,unit\n../outside.csv,u1\n"),
            "set/labels.csv:2:1: error: file is '../outside.csv' (expected a file below the folder)");
  EXPECT_EQ(MessageOf("file,unit\n/etc/hostname,u1\n"),
            "set/labels.csv:2:1: error: file is '/etc/hostname' (expected a file below the folder)");
  EXPECT_EQ(MessageOf("file,unit\na.csv,\n"),
            "set/labels.csv:2:7: error: unit is empty (expected a name of the assembly or specimen)");
}

TEST_F(LabelsFile, NumbersHaveARange) {
  const Labels labels = Read("file,unit,health_hd\na.csv,u1,0.5\nb.csv,u2,1.5\n");
  try {
    labels.Numbers("health_hd", 0.0, 1.0);
    FAIL();
  } catch (const BenchError& error) {
    EXPECT_EQ(Plain(error), "set/labels.csv:3:10: error: health_hd is '1.5' (expected a number from 0 to 1)");
  }
  try {
    labels.Texts("class");
    FAIL();
  } catch (const BenchError& error) {
    EXPECT_EQ(
        Plain(error),
        "set/labels.csv:1:1: error: column 'class' is missing (expected it beside file, unit, health_hd)");
  }
  for (const char* text : {"nan", "", "inf", "0,5"}) {
    const std::string cell = std::string(text) == "0,5" ? "\"0,5\"" : text;
    EXPECT_THROW(Read("file,unit,h\na.csv,u1," + cell + "\n").Numbers("h", 0.0, 1.0), BenchError) << text;
  }
}

TEST_F(LabelsFile, RefusesAFolderWithoutATable) {
  try {
    ReadLabels(folder_.path());
    FAIL();
  } catch (const BenchError& error) {
    EXPECT_TRUE(std::string(error.what())
                    .ends_with(": error: has no labels.csv (expected a table with the columns file, unit and "
                               "what is known of each file)"))
        << error.what();
  }
  try {
    ReadLabels(folder_ / "none");
    FAIL();
  } catch (const BenchError& error) {
    EXPECT_EQ(Plain(error), "none: error: is no folder (expected a folder of records with labels.csv)");
  }
}

TEST(NumbersOfGroups, AreConsecutiveInTheOrderOfAppearance) {
  EXPECT_EQ(NumbersOfGroups({"b", "a", "b", "c", "a"}), (std::vector<int>{0, 1, 0, 2, 1}));
}

}  // namespace
}  // namespace strainwave::bench::labels_test
