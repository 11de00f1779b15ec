// SPDX-License-Identifier: Apache-2.0
#include "daq/cycle_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "daq/hdf5_attributes.h"
#include "daq/hdf5_handle.h"
#include "daq/hdf5_image.h"
#include "daq/read_records.h"
#include "daq/record_error.h"
#include "daq/sensor_serials.h"
#include "daq/whole_file.h"
#include "tests/daq/sample_records.h"
#include "tests/daq/scratch_folder.h"

// HDF5 1.10.8 does not free an object header whose checksum it refused; the leak sanitizer asks here.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }

namespace strainwave::daq::cycle_file_test {
namespace {

const std::vector<NamedRecord>& Samples() {
  static const std::vector<NamedRecord> samples{
      {"sweep", SampleSweep()}, {"repeat/2/hysteresis", SampleLoop()}, {"accel", SampleVibration()}};
  return samples;
}

const Attributes kAttributes{{"specimen", "A-3"}, {"cycle", "17"}, {"schedule_sha256", "ab12"}};

TEST(CycleFile, IsBuiltBesideAnother) {
  const Hdf5Handle one = CreateHdf5InMemory();
  const Hdf5Handle other = CreateHdf5InMemory();
  EXPECT_EQ(ImageOfHdf5(one.get()), ImageOfHdf5(other.get()));
}

// A heap of attributes, which readers of others do not know, has bytes beside the object's header.
TEST(CycleFile, KeepsAttributesWhereOtherReadersFindThem) {
  Record record = SampleVibration();
  for (int i = 0; i < 30; ++i) record.SetMetadata(fmt::format("key_{}", i), "text");
  record.columns.front().calibration = "T-1";
  record.columns.front().calibration_terms = {{"sensitivity", "0.01"},
                                              {"zero", "0"},
                                              {"polynomial", "0 1"},
                                              {"calibration_date", "2026-01-01"},
                                              {"calibration_due", "2027-01-01"}};
  const ScratchFolder folder;
  WriteRecordsAtomically(folder / "a.h5", std::vector<NamedRecord>{{"accel", record}}, kAttributes);
  EXPECT_TRUE(SameRecord(ReadCycleFile(folder / "a.h5").records[0].record, record));
  const Hdf5Handle file = OpenHdf5ForReading(folder / "a.h5");
  for (const auto& [object, attributes] :
       {std::pair("/", 5), {"/accel", 32}, {"/accel/accel_x_m_per_s2", 9}}) {
    H5O_info_t info{};
    Check(H5Oget_info_by_name2(file.get(), object, &info, H5O_INFO_NUM_ATTRS | H5O_INFO_META_SIZE,
                               H5P_DEFAULT));
    EXPECT_EQ(info.num_attrs, static_cast<hsize_t>(attributes)) << object;
    EXPECT_EQ(info.meta_size.attr.heap_size + info.meta_size.attr.index_size, 0U) << object;
  }
}

TEST(CycleFile, ReadsBackToTheSameBits) {
  const ScratchFolder folder;
  WriteRecordsAtomically(folder / "000017.h5", Samples(), kAttributes);
  const CycleFile read = ReadCycleFile(folder / "000017.h5");
  EXPECT_EQ(read.attributes, kAttributes);
  ASSERT_EQ(read.records.size(), 3U);
  EXPECT_EQ(read.records[0].group, "/sweep");
  EXPECT_EQ(read.records[1].group, "/repeat/2/hysteresis");
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(SameRecord(read.records[i].record, Samples()[i].record)) << i;
    EXPECT_EQ(read.records[i].record.source.group, read.records[i].group);
  }
}

TEST(CycleFile, ReadsTheColumnsAskedForAlone) {
  const ScratchFolder folder;
  WriteRecordsAtomically(folder / "000017.h5", Samples(), kAttributes);
  const std::string_view wanted[] = {"torque_Nm", "not_there"};
  const CycleFile read = ReadCycleFile(folder / "000017.h5", Checking::kNone, wanted);
  EXPECT_EQ(read.attributes, kAttributes);
  ASSERT_EQ(read.records.size(), 3U);
  EXPECT_TRUE(read.records[0].record.columns.empty());
  ASSERT_EQ(read.records[1].record.columns.size(), 1U);
  EXPECT_EQ(read.records[1].record.kind, SampleLoop().kind);
  EXPECT_EQ(read.records[1].record.CopyAsDoubles("torque_Nm"), SampleLoop().CopyAsDoubles("torque_Nm"));
}

// Read by the library alone, so that nobody's reader grades its own writer.
TEST(CycleFile, SaysWhichProgramHasWrittenIt) {
  const ScratchFolder folder;
  WriteRecordsAtomically(folder / "a.h5", Samples(), kAttributes);
  const Hdf5Handle file = OpenHdf5ForReading(folder / "a.h5");
  const Hdf5Handle attribute(H5Aopen(file.get(), "software", H5P_DEFAULT), H5Aclose);
  const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose);
  std::string text(H5Tget_size(type.get()), '?');
  ASSERT_GE(H5Aread(attribute.get(), type.get(), text.data()), 0);
  EXPECT_EQ(text, "strainwave " STRAINWAVE_VERSION);  // that of a program with a commit: tests/packaging
}

TEST(CycleFile, OfAnotherFormatIsRefused) {
  const ScratchFolder folder;
  WriteRecordsAtomically(folder / "a.h5", Samples(), kAttributes);
  {
    const Hdf5Handle file(H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    H5Adelete(file.get(), "strainwave_format");
    WriteAttribute(file.get(), "strainwave_format", "2");
  }
  EXPECT_EQ(
      MessageOf<RecordError>([&] { ReadCycleFile(folder / "a.h5"); }),
      (folder / "a.h5").string() +
          ": error: attribute 'strainwave_format' is 2 (expected 1, the format that this version reads)");
}

TEST(CycleFile, LeavesNothingElseInTheFolder) {
  const ScratchFolder folder;
  WriteBytes(folder / ".000017.h5.partial", "left behind by a killed process, and longer than nothing");
  WriteRecordsAtomically(folder / "000017.h5", Samples());
  const auto files = std::filesystem::directory_iterator(folder.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

TEST(CycleFile, HasTheSameBytesForTheSameRecords) {
  const ScratchFolder folder;
  WriteRecordsAtomically(folder / "a.h5", Samples(), kAttributes);
  WriteRecordsAtomically(folder / "b.h5", Samples(), kAttributes);
  EXPECT_EQ(BytesOf(folder / "a.h5"), BytesOf(folder / "b.h5"));
}

// Two files of one second would have the same bytes even with it.
TEST(CycleFile, HoldsNoTimeOfDay) {
  const ScratchFolder folder;
  WriteRecordsAtomically(folder / "a.h5", Samples(), kAttributes);
  const Hdf5Handle file = OpenHdf5ForReading(folder / "a.h5");
  for (const char* path : {"/", "/repeat", "/repeat/2/hysteresis", "/repeat/2/hysteresis/torque_Nm"}) {
    H5O_info_t info{};
    ASSERT_GE(H5Oget_info_by_name2(file.get(), path, &info, H5O_INFO_TIME, H5P_DEFAULT), 0);
    EXPECT_EQ(info.mtime, 0) << path;
    EXPECT_EQ(info.ctime, 0) << path;
  }
}

TEST(CycleFile, KeepsALongRecordInChunks) {
  const ScratchFolder folder;
  Record record = SampleVibration();
  std::vector<float> values;
  for (int i = 0; i < 200000; ++i) values.push_back(static_cast<float>(i) * 0.25F);
  for (Column& column : record.columns) column.values = values;
  WriteRecordsAtomically(folder / "a.h5", std::vector<NamedRecord>{{"accel", record}});
  EXPECT_TRUE(SameRecord(ReadCycleFile(folder / "a.h5").records[0].record, record));
}

TEST(CycleFile, StoresWhatASensorThatDiedMeasured) {
  const ScratchFolder folder;
  Record record = SampleLoop();
  std::get<std::vector<double>>(record.columns[1].values)[2] = std::nan("");
  WriteRecordsAtomically(folder / "a.h5", std::vector<NamedRecord>{{"loop", record}});
  EXPECT_TRUE(
      std::isnan(ReadCycleFile(folder / "a.h5", Checking::kNone).records[0].record.Doubles("torque_Nm")[2]));
  const std::string path = (folder / "a.h5").string();
  EXPECT_EQ(
      MessageOf<RecordError>([&] { ReadCycleFile(path); }),
      path +
          ": error: group '/loop', dataset 'torque_Nm', row 2: torque_Nm is nan (expected a finite number)");
}

TEST(CycleFile, KeepsTheHistoryAroundAnEvent) {
  const ScratchFolder folder;
  Record record;
  record.kind = RecordKind::kHistory;
  record.columns.push_back({"time_s", std::vector{-0.002, -0.001, 0.0}, "", ""});
  record.columns.push_back({"torque_Nm", std::vector{1.0, std::nan(""), 90.0}, "", ""});
  WriteRecordsAtomically(folder / "a.h5", std::vector<NamedRecord>{{"trip", record}});
  EXPECT_EQ(ReadRecords(folder / "a.h5").at(0).Doubles("torque_Nm")[2], 90.0);
}

TEST(CycleFile, RefusesWhatCannotBeWritten) {
  const ScratchFolder folder;
  using Error = std::invalid_argument;
  const auto message_of = [&](const std::vector<NamedRecord>& records, const Attributes& attributes = {}) {
    return MessageOf<Error>([&] { WriteRecordsAtomically(folder / "a.h5", records, attributes); });
  };
  const auto message_with = [&](auto change) {
    Record record = SampleLoop();
    change(record);
    return message_of({{"x", record}});
  };
  EXPECT_EQ(message_of({}), "no record to write to '" + (folder / "a.h5").string() + "'");
  EXPECT_EQ(message_of({{"x", SampleLoop()}, {"/x", SampleLoop()}}), "two records have the group '/x'");
  EXPECT_EQ(message_of({{"/", SampleLoop()}}), "a record of a cycle file has a group of its own");
  EXPECT_EQ(message_of({{"x", SampleLoop()}}, {{"software", "a"}}),
            "record '/': file attribute 'software' is empty, has a NUL in it or its value, or is taken");
  EXPECT_EQ(message_of({{"x", SampleLoop()}}, {{"kind", "a"}}),
            "record '/': file attribute 'kind' is empty, has a NUL in it or its value, or is taken");
  EXPECT_EQ(message_with([](Record& r) { r.kind = RecordKind::Named(""); }),
            "record '/x': the kind is empty");
  EXPECT_EQ(message_with([](Record& r) { r.columns.clear(); }), "record '/x': it has no rows");
  EXPECT_EQ(message_with([](Record& r) { r.columns[1].values = std::vector{1.0}; }),
            "record '/x': column 'torque_Nm' has 1 rows, not 3");
  EXPECT_EQ(message_with([](Record& r) { r.columns[1].name = "a/b"; }),
            "record '/x': column name 'a/b' cannot name a dataset");
  EXPECT_EQ(message_with([](Record& r) { r.SetMetadata("kind", "a"); }),
            "record '/x': metadata key 'kind' is empty, has a NUL in it or its value, or is taken");
  EXPECT_EQ(message_with([](Record& r) { r.columns[1].name = "time_s"; }),
            "record '/x': column 'time_s' is doubled");
  EXPECT_TRUE(folder.is_empty());
}

TEST(CycleFile, IsNamedWithItsTwoSizesWhenCutShort) {
  const ScratchFolder folder;
  WriteRecordsAtomically(folder / "a.h5", Samples(), kAttributes);
  const std::string whole = BytesOf(folder / "a.h5");
  const std::string path = (folder / "cut.h5").string();
  WriteBytes(path, whole.substr(0, 1000));
  EXPECT_EQ(MessageOf<RecordError>([&] { ReadCycleFile(path); }),
            path + ": error: not a complete HDF5 file (truncated: 1000 of " + std::to_string(whole.size()) +
                " bytes) (expected the file as it was written)");
  EXPECT_EQ(MessageOf<RecordError>([&] { ReadRecords(path); }).substr(0, path.size() + 10),
            path + ": error: n");
}

TEST(CycleFile, NeverReadsAfterAnyCut) {
  const ScratchFolder folder;
  WriteRecordsAtomically(folder / "a.h5", std::vector<NamedRecord>{{"loop", SampleLoop()}});
  const std::string whole = BytesOf(folder / "a.h5");
  std::size_t cuts = 0;
  for (std::size_t length = 0; length < whole.size(); length += length < 600 ? 1 : 97) {
    WriteBytes(folder / "cut.h5", whole.substr(0, length));
    EXPECT_THROW(ReadCycleFile(folder / "cut.h5"), RecordError) << length;
    // The same in a process of its own, which takes longer.
    if (cuts++ % 16 == 0) {
      EXPECT_THROW(ReadRecords(folder / "cut.h5"), RecordError) << length;
    }
  }
}

// Times that become few bytes, and noise that does not.
std::vector<NamedRecord> LongRecords() {
  Record record = SampleVibration();
  std::vector<double> time_s;
  std::vector<float> noise;
  std::uint32_t state = 1;
  for (int i = 0; i < 300; ++i) {
    time_s.push_back(i / 1024.0);
    state = state * 1664525U + 1013904223U;
    noise.push_back(static_cast<float>(state) / 4e9F);
  }
  record.columns = {{"time_s", time_s, "", ""}, {"accel_x_m_per_s2", noise, "A-1", ""}};
  return {{"accel", record}};
}

TEST(CycleFile, IsDeflatedWhereThatPaysAndReadsBackToTheSameBits) {
  const ScratchFolder folder;
  const std::vector<NamedRecord> records = LongRecords();
  const std::vector<std::byte> image = ImageOfRecords(records, kAttributes, "a.h5", Packing::kDeflated);
  EXPECT_EQ(image, ImageOfRecords(records, kAttributes, "a.h5", Packing::kDeflated));
  WriteFileAtomically(folder / "a.h5", image);
  EXPECT_TRUE(SameRecord(ReadCycleFile(folder / "a.h5").records[0].record, records[0].record));
  const Hdf5Handle file = OpenHdf5ForReading(folder / "a.h5");
  for (const auto& [name, most_bytes] :
       {std::pair("/accel/time_s", 1200), {"/accel/accel_x_m_per_s2", 1204}}) {
    const Hdf5Handle dataset(H5Dopen2(file.get(), name, H5P_DEFAULT), H5Dclose);
    EXPECT_LE(H5Dget_storage_size(dataset.get()), static_cast<hsize_t>(most_bytes)) << name;
    EXPECT_GT(H5Dget_storage_size(dataset.get()), 100U) << name;
  }
}

// Every byte of a file in turn: what is read is either refused or unchanged.
void ExpectNothingElseWithOneByteFlipped(const std::vector<NamedRecord>& records, Packing packing,
                                         int least_refused) {
  const ScratchFolder folder;
  WriteFileAtomically(folder / "a.h5", ImageOfRecords(records, kAttributes, "a.h5", packing));
  const std::string whole = BytesOf(folder / "a.h5");
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << (at % 8)));
    WriteBytes(folder / "flipped.h5", flipped);
    try {
      const CycleFile read = ReadCycleFile(folder / "flipped.h5", Checking::kNone);
      ASSERT_EQ(read.records.size(), records.size()) << "byte " << at;
      EXPECT_EQ(read.attributes, kAttributes) << "byte " << at;
      for (std::size_t i = 0; i < records.size(); ++i) {
        EXPECT_TRUE(SameRecord(read.records[i].record, records[i].record))
            << "byte " << at << " record " << i;
      }
    } catch (const RecordError&) {
      ++refused;
    }
  }
  // The rest is room that HDF5 left unused.
  EXPECT_GT(refused, least_refused);
}

TEST(CycleFile, NeverReadsAnythingElseWithOneByteFlipped) {
  ExpectNothingElseWithOneByteFlipped({{"loop", SampleLoop()}, {"sweep", SampleSweep()}}, Packing::kPlain,
                                      2000);
  ExpectNothingElseWithOneByteFlipped(LongRecords(), Packing::kDeflated, 2500);
}

TEST(CycleFile, SaysThatAForeignFileHasNoRecord) {
  const ScratchFolder folder;
  const std::string path = (folder / "junk.h5").string();
  const auto message = [&] { return MessageOf<RecordError>([&] { ReadCycleFile(path); }); };
  EXPECT_EQ(message(), path + ": error: No such file or directory (expected a record file)");
  WriteBytes(path, "");
  EXPECT_EQ(message(), path + ": error: the file is empty (expected an HDF5 file)");
  WriteBytes(path, "SQLite format 3");
  EXPECT_EQ(message(), path + ": error: not an HDF5 file (expected an HDF5 file)");
  EXPECT_EQ(MessageOf<RecordError>([&] { ReadCycleFile(folder.path()); }),
            folder.path().string() + ": error: Is a directory (expected a record file)");
}

TEST(ReadSensorSerials, NamesEachSensorOnceWithItsColumn) {
  const ScratchFolder folder;
  std::vector<NamedRecord> records = Samples();
  records.push_back({"again", SampleLoop()});  // the same transducer a second time
  WriteRecordsAtomically(folder / "serials.h5", records);
  EXPECT_EQ(ReadSensorSerials(folder / "serials.h5"),
            (std::vector<std::string>{"accel_x_m_per_s2=A-1", "torque_Nm=0815"}));
  EXPECT_THROW(ReadSensorSerials(folder / "none.h5"), RecordError);
}

TEST(ReadRecords, KnowWhoseTheyAreByTheFile) {
  const ScratchFolder folder;
  WriteRecordsAtomically(folder / "a.h5", Samples(), kAttributes);
  for (const Record& record : ReadRecords(folder / "a.h5")) EXPECT_EQ(record.source.specimen, "A-3");
  WriteRecordsAtomically(folder / "b.h5", Samples());
  for (const Record& record : ReadRecords(folder / "b.h5")) EXPECT_EQ(record.source.specimen, "");
}

TEST(ReadRecords, TellsHdf5FromCsvByContentAndNotByName) {
  const ScratchFolder folder;
  WriteRecordsAtomically(folder / "misleading.csv", Samples());
  EXPECT_EQ(ReadRecords(folder / "misleading.csv").size(), 3U);
  WriteBytes(folder / "misleading.h5", "# kind: hysteresis\ntime_s,torque_Nm,output_angle_deg\n0,1,2\n");
  const std::vector<Record> records = ReadRecords(folder / "misleading.h5");
  ASSERT_EQ(records.size(), 1U);
  EXPECT_EQ(records[0].kind, RecordKind::kHysteresis);
  EXPECT_EQ(MessageOf<RecordError>([&] { ReadRecords(folder.path()); }),
            folder.path().string() + ": error: Is a directory (expected a record file)");
}

}  // namespace
}  // namespace strainwave::daq::cycle_file_test
