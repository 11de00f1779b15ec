// SPDX-License-Identifier: Apache-2.0
// HDF5 files that are replayed: streams whose head, channels and tables say anything, and records with any
// times and rate.
#include <hdf5.h>

#include <cstdint>
#include <cstring>

#include "daq/acquisition/stream_tables.h"
#include "daq/hdf5_attributes.h"
#include "daq/hdf5_image.h"
#include "daq/hdf5_record.h"
#include "tests/fuzz/replay_check.h"

namespace {

using namespace strainwave::daq;
using acquisition::BlockRow;
using acquisition::GapRow;

// The input, value after value; zeros when there is no more.
class Input {
 public:
  explicit Input(std::span<const std::uint8_t> data) : data_(data) {}
  template <typename Value>
  Value Take() {
    Value value{};
    const std::size_t size = std::min(sizeof(Value), data_.size());
    std::memcpy(&value, data_.data(), size);
    data_ = data_.subspan(size);
    return value;
  }
  std::string Text() {
    std::string text;
    for (int left = Take<std::uint8_t>() % 16; left > 0; --left) text += Take<char>();
    return text;
  }
  // Most often small, so that rows fit to each other.
  std::uint64_t Number() {
    const std::uint8_t first = Take<std::uint8_t>();
    return first == 255 ? Take<std::uint64_t>() : first % 8;
  }

 private:
  std::span<const std::uint8_t> data_;
};

Hdf5Handle Write(hid_t file, const char* name, hid_t file_type, hid_t type, std::span<const hsize_t> extent,
                 const void* values) {
  const Hdf5Handle space(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
  Hdf5Handle dataset(H5Dcreate2(file, name, file_type, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
  if (values != nullptr) Check(H5Dwrite(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
  return dataset;
}

template <typename Row>
void WriteTable(hid_t file, const char* name, const std::vector<Row>& rows, Hdf5Handle (*type)(bool)) {
  const hsize_t extent[] = {rows.size()};
  Write(file, name, type(true).get(), type(false).get(), extent, rows.empty() ? nullptr : rows.data());
}

void WriteStream(hid_t file, Input& input) {
  const std::uint8_t kind = input.Take<std::uint8_t>();
  WriteAttribute(file, "strainwave_stream", "1");
  for (const char* name : {"source", "source_number", "rate_hz", "counter_bits"}) {
    const std::string text = input.Text();
    WriteAttribute(file, name, text.empty() ? "16" : text);
  }
  const hsize_t extent[] = {kind % 32U, 1U + kind / 32 % 4};
  const hid_t type = kind % 5 == 0 ? H5T_NATIVE_INT32 : kind % 5 == 1 ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT;
  Write(file, "samples", type, type, extent, nullptr);
  const Hdf5Handle group(H5Gcreate2(file, "channels", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  for (hsize_t i = 0; i < extent[1]; ++i) {
    const std::string name = "c" + std::to_string(i);
    const Hdf5Handle channel(H5Gcreate2(group.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                             H5Gclose);
    const std::string column = input.Text();
    WriteAttribute(channel.get(), "column", column.empty() ? std::to_string(i) : column);
    for (const char* term : {"sensitivity", "zero", "polynomial", "calibration_due"}) {
      if (const std::string text = input.Text(); !text.empty()) WriteAttribute(channel.get(), term, text);
    }
  }
  std::vector<BlockRow> blocks(input.Take<std::uint8_t>() % 8);
  std::uint64_t row = 0;
  for (BlockRow& block : blocks) {
    block.row = row + (input.Take<std::uint8_t>() == 1 ? input.Number() : 0);
    block.samples = static_cast<std::uint32_t>(input.Number());
    block.first_sample = input.Number();
    block.arrival_ns = static_cast<std::int64_t>(input.Number());
    row += block.samples;
  }
  WriteTable(file, "blocks", blocks, acquisition::BlockRowType);
  std::vector<GapRow> gaps(input.Take<std::uint8_t>() % 4);
  for (GapRow& gap : gaps) gap = input.Take<GapRow>();
  WriteTable(file, "gaps", gaps, acquisition::GapRowType);
}

void WriteAnyRecord(hid_t file, Input& input) {
  Record record;
  record.kind = strainwave::daq::RecordKind::kVibration;
  if (const std::string rate = input.Text(); !rate.empty()) record.SetMetadata("sample_rate_hz", rate);
  const std::size_t rows = 1 + input.Take<std::uint8_t>() % 16;
  const bool has_time = input.Take<std::uint8_t>() % 2 == 0;
  std::vector<double> time_s(rows), values(rows);
  for (double& time : time_s) time = input.Take<double>();
  for (double& value : values) value = input.Take<float>();
  if (has_time) record.columns.push_back({"time_s", std::move(time_s), {}, {}});
  record.columns.push_back({"accel_x_m_per_s2", std::move(values), {}, {}});
  WriteRecordGroup(file, "/record", record);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(std::span(data, size));
  const bool is_record = input.Take<std::uint8_t>() % 2 == 1;
  std::vector<std::byte> bytes;
  try {
    const Hdf5Silence silence;
    const Hdf5Handle file = CreateHdf5InMemory();
    is_record ? WriteAnyRecord(file.get(), input) : WriteStream(file.get(), input);
    bytes = ImageOfHdf5(file.get());
  } catch (const std::invalid_argument&) {
    return 0;
  } catch (const Hdf5Error&) {
    return 0;  // an attribute that no file can hold
  }
  ReplayToTheEnd(FileInMemory(bytes).path(), 3, is_record);
  return 0;
}
