// SPDX-License-Identifier: Apache-2.0
#include "daq/growing_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "daq/record_error.h"

namespace strainwave::daq::growing_file_test {
namespace {

constexpr std::size_t kBlocks = 3;
constexpr std::size_t kRowsPerBlock = 10;

// A history so far, with a summary that changes beside it.
std::vector<NamedRecord> RecordsOf(std::size_t rows) {
  Record history;
  history.kind = RecordKind::kHistory;
  history.SetMetadata("credited_load_s", static_cast<double>(rows));
  Column time{"time_s", std::vector<double>{}, "", ""};
  Column torque{"torque_Nm", std::vector<float>{}, "T-0815", "C-17", {{"sensitivity", "2"}}};
  for (std::size_t i = 0; i < rows; ++i) {
    std::get<0>(time.values).push_back(0.1 * static_cast<double>(i));
    std::get<1>(torque.values).push_back(static_cast<float>(i * i));
  }
  history.columns = {time, torque};
  Record summary;
  summary.kind = RecordKind::kHistory;
  summary.columns = {{"x_mean_m_per_s2", std::vector<double>{static_cast<double>(rows)}, "", ""}};
  return {{"load_run/load_run", history}, {"load_run/vibration_statistics", summary}};
}

void ExpectRecords(const GrownFile& file, std::size_t rows) {
  const auto expected = RecordsOf(rows);
  ASSERT_EQ(file.records.size(), expected.size()) << rows;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Record& read = file.records[i].record;
    const Record& written = expected[i].record;
    EXPECT_EQ(file.records[i].group, expected[i].group);
    EXPECT_EQ(read.kind, written.kind);
    EXPECT_EQ(read.metadata, written.metadata);
    ASSERT_EQ(read.columns.size(), written.columns.size());
    for (std::size_t c = 0; c < written.columns.size(); ++c) {
      EXPECT_EQ(read.columns[c].name, written.columns[c].name);
      EXPECT_EQ(read.columns[c].values, written.columns[c].values);
      EXPECT_EQ(read.columns[c].sensor_serial, written.columns[c].sensor_serial);
      EXPECT_EQ(read.columns[c].calibration, written.columns[c].calibration);
      EXPECT_EQ(read.columns[c].calibration_terms, written.columns[c].calibration_terms);
    }
  }
}

class GrowingFileOnDisk : public testing::Test {
 protected:
  GrowingFileOnDisk() {
    std::filesystem::create_directories(folder_);
    GrowingFile growing(file_, attributes_);
    for (std::size_t block = 1; block <= kBlocks; ++block) {
      growing.Append(RecordsOf(block * kRowsPerBlock));
      ends_.push_back(std::filesystem::file_size(file_));
    }
    std::ifstream stream(file_, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(stream), {});
  }
  ~GrowingFileOnDisk() override { std::filesystem::remove_all(folder_); }

  void Leave(const std::string& bytes) { std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes; }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("strainwave_growing_" + std::to_string(::getpid()));
  std::filesystem::path file_ = folder_ / "a.rows";
  Attributes attributes_{{"campaign", "00ff"}, {"attempt", "2"}};
  std::vector<std::size_t> ends_;
  std::string bytes_;
};

TEST_F(GrowingFileOnDisk, ReadsAsTheRecordsThatItWasGiven) {
  const GrownFile file = ReadGrowingFile(file_);
  EXPECT_EQ(file.attributes, attributes_);
  EXPECT_EQ(file.lost_bytes, 0U);
  ExpectRecords(file, kBlocks * kRowsPerBlock);
}

TEST_F(GrowingFileOnDisk, GrowsByTheNewRowsAlone) {
  EXPECT_EQ(ends_[2] - ends_[1], ends_[1] - ends_[0]);
  EXPECT_EQ(bytes_.size(), ends_.back());
}

TEST_F(GrowingFileOnDisk, CutAnywhereLosesTheBlockThatWasCut) {
  for (std::size_t length = 0; length < bytes_.size(); ++length) {
    Leave(bytes_.substr(0, length));
    const GrownFile file = ReadGrowingFile(file_);
    const std::size_t whole = length < ends_[0] ? 0 : length < ends_[1] ? 1 : 2;
    EXPECT_EQ(file.lost_bytes, length - (whole == 0 ? 0 : ends_[whole - 1])) << length;
    if (whole == 0) {
      EXPECT_TRUE(file.records.empty()) << length;
    } else {
      ExpectRecords(file, whole * kRowsPerBlock);
    }
  }
}

TEST_F(GrowingFileOnDisk, WithABitChangedIsRefusedOrLosesTheLastBlock) {
  for (std::size_t at = 0; at < bytes_.size(); ++at) {
    std::string changed = bytes_;
    changed[at] = static_cast<char>(changed[at] ^ (1 << (at % 8)));
    Leave(changed);
    if (at >= ends_[1]) {
      const GrownFile file = ReadGrowingFile(file_);
      EXPECT_EQ(file.lost_bytes, ends_[2] - ends_[1]) << at;
      ExpectRecords(file, 2 * kRowsPerBlock);
      continue;
    }
    try {
      ReadGrowingFile(file_);
      FAIL() << "read with a bit changed in byte " << at;
    } catch (const RecordError& error) {
      EXPECT_EQ(std::string(error.what()),
                file_.string() + ": error: block " + (at < ends_[0] ? "1" : "2") +
                    " does not match its checksum (expected the file as it was written)");
    }
  }
}

TEST_F(GrowingFileOnDisk, BeginsAnew) {
  GrowingFile(file_, {}).Append(RecordsOf(4));
  ExpectRecords(ReadGrowingFile(file_), 4);
}

}  // namespace
}  // namespace strainwave::daq::growing_file_test
