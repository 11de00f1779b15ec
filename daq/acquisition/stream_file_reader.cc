// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/stream_file_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "daq/hdf5_attributes.h"
#include "daq/record.h"
#include "daq/record_error.h"

namespace strainwave::daq::acquisition {
namespace {

constexpr std::uint64_t kMostTableRows = std::uint64_t{1} << 26;
constexpr std::size_t kMostChannels = 4096;

std::optional<std::string> TextOf(const Attributes& attributes, const std::string& name) {
  for (const auto& [key, text] : attributes) {
    if (key == name) return text;
  }
  return std::nullopt;
}

Attributes AttributesOfObject(hid_t object) {
  std::vector<std::string> left_out;
  Attributes attributes;
  for (Hdf5Attribute& attribute : ReadAttributes(object, left_out)) {
    attributes.emplace_back(std::move(attribute.name), std::move(attribute.text));
  }
  return attributes;
}

Hdf5Handle Open(const std::filesystem::path& path) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  Check(H5Pset_file_locking(access.get(), false, true));
  // A file whose writer lives, or was killed, opens in no other way.
  const hid_t swmr = H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access.get());
  if (swmr >= 0) return {swmr, H5Fclose};
  return OpenHdf5ForReading(path);
}

std::vector<hsize_t> ExtentOf(hid_t dataset) {
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  std::vector<hsize_t> extent(
      static_cast<std::size_t>(std::max(0, Check(H5Sget_simple_extent_ndims(space.get())))));
  Check(H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr));
  return extent;
}

template <typename Row>
std::vector<Row> ReadTable(hid_t file, const char* name, const Hdf5Handle& type) {
  const Hdf5Handle dataset(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  const std::vector<hsize_t> extent = ExtentOf(dataset.get());
  if (extent.size() != 1 || extent[0] > kMostTableRows) throw Hdf5Error(fmt::format("/{} is no table", name));
  std::vector<Row> rows(extent[0]);
  if (!rows.empty()) Check(H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()));
  return rows;
}

}  // namespace

bool IsStreamFile(const std::filesystem::path& path) {
  const Hdf5Silence silence;
  if (H5Fis_hdf5(path.c_str()) <= 0) return false;
  try {
    const Hdf5Handle file = Open(path);
    return H5Aexists(file.get(), "strainwave_stream") > 0;
  } catch (const Hdf5Error& error) {
    throw RecordError(path.string(), error.what(), "an HDF5 file");
  }
}

void StreamFileReader::Refuse(const std::string& what, const std::string& expected) const {
  throw RecordError(path_, what, expected);
}

StreamFileReader::StreamFileReader(const std::filesystem::path& path) : path_(path.string()) {
  if (!std::filesystem::is_regular_file(path)) OpenHdf5ForReading(path);
  try {
    file_.emplace(Open(path));
    if (H5Aexists(file_->get(), "strainwave_stream") <= 0)
      Refuse("no stream is in the file", "the attribute 'strainwave_stream'");
    ReadHead();
    ReadChannels();
    ReadTables();
  } catch (const Hdf5Error& error) {
    Refuse(fmt::format("HDF5 cannot read it: {}", error.what()), "a stream as it was written");
  } catch (const std::invalid_argument& error) {
    Refuse(error.what(), "a stream as it was written");
  }
}

void StreamFileReader::ReadHead() {
  const Hdf5Handle root(H5Gopen2(file_->get(), "/", H5P_DEFAULT), H5Gclose);
  attributes_ = AttributesOfObject(root.get());
  const auto number = [this](const char* name) {
    const std::optional<std::string> text = TextOf(attributes_, name);
    const std::optional<double> value = text ? NumberFromText(*text) : std::nullopt;
    if (!value || !(*value >= 0) || !(*value < 1e12)) {
      Refuse(fmt::format("attribute '{}' is {}", name, text.value_or("missing")), "a number not below zero");
    }
    return *value;
  };
  if (const double format = number("strainwave_stream"); format != 1)
    Refuse(fmt::format("attribute 'strainwave_stream' is {}", format),
           "1, the format that this version reads");
  description_.name = TextOf(attributes_, "source").value_or("");
  description_.source = static_cast<std::uint32_t>(std::min(number("source_number"), 4e9));
  description_.rate_hz = number("rate_hz");
  description_.counter_bits = static_cast<unsigned>(std::min(number("counter_bits"), 64.0));
  if (description_.rate_hz == 0) Refuse("attribute 'rate_hz' is 0", "a number above zero");
}

void StreamFileReader::ReadChannels() {
  samples_.emplace(H5Dopen2(file_->get(), "samples", H5P_DEFAULT), H5Dclose);
  const std::vector<hsize_t> extent = ExtentOf(samples_->get());
  if (extent.size() != 2 || extent[1] == 0 || extent[1] > kMostChannels) {
    Refuse("dataset 'samples' is not rows of channels", "two dimensions");
  }
  rows_ = extent[0];
  const Hdf5Handle type(H5Dget_type(samples_->get()), H5Tclose);
  description_.type = H5Tget_class(type.get()) == H5T_INTEGER ? SampleType::kInt32 : SampleType::kFloat32;
  if (H5Tget_size(type.get()) != sizeof(std::uint32_t))
    Refuse("dataset 'samples' does not hold values of 4 bytes", "int32 or float32");

  const Hdf5Handle group(H5Gopen2(file_->get(), "channels", H5P_DEFAULT), H5Gclose);
  H5G_info_t info{};
  Check(H5Gget_info(group.get(), &info));
  description_.channels.resize(extent[1]);
  std::vector<bool> known(extent[1]);
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    std::array<char, 1024> name{};
    Check(H5Lget_name_by_idx(group.get(), ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(),
                             H5P_DEFAULT));
    const Hdf5Handle channel_group(H5Gopen2(group.get(), name.data(), H5P_DEFAULT), H5Gclose);
    const Attributes attributes = AttributesOfObject(channel_group.get());
    const std::optional<double> column = NumberFromText(TextOf(attributes, "column").value_or(""));
    if (!column || !(*column >= 0) || !(*column < static_cast<double>(extent[1])) ||
        known[static_cast<std::size_t>(*column)]) {
      Refuse(fmt::format("channel '{}' has no column of its own", name.data()),
             "a column of 'samples' for each channel");
    }
    const auto index = static_cast<std::size_t>(*column);
    known[index] = true;
    description_.channels[index] = {.name = name.data(),
                                    .unit = TextOf(attributes, "unit").value_or(""),
                                    .sensor_serial = TextOf(attributes, "sensor_serial").value_or(""),
                                    .calibration = CalibrationFrom(attributes)};
  }
  if (std::find(known.begin(), known.end(), false) != known.end()) {
    Refuse("a column of 'samples' has no channel", "a group in '/channels' for each column");
  }
}

void StreamFileReader::ReadTables() {
  blocks_ = ReadTable<BlockRow>(file_->get(), "blocks", BlockRowType(false));
  gaps_ = ReadTable<GapRow>(file_->get(), "gaps", GapRowType(false));
  std::uint64_t row = 0;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].row != row)
      Refuse(fmt::format("block {} begins at row {}", i, blocks_[i].row), fmt::format("row {}", row));
    // A killed writer may have left a block in the table whose samples are not there; what is there counts.
    if (blocks_[i].samples > rows_ - row) {
      blocks_.resize(i);
      break;
    }
    row += blocks_[i].samples;
    description_.most_samples_a_block = std::max(description_.most_samples_a_block, blocks_[i].samples);
  }
  rows_ = row;
}

std::vector<std::uint32_t> StreamFileReader::Words(std::uint64_t row, std::uint64_t count) const {
  if (row > rows_ || count > rows_ - row)
    throw std::out_of_range(fmt::format("rows {} to {} of {}", row, row + count, rows_));
  const std::size_t channels = description_.channels.size();
  std::vector<std::uint32_t> words(count * channels);
  if (count == 0) return words;
  const std::array<hsize_t, 2> begin{row, 0};
  const std::array<hsize_t, 2> shape{count, channels};
  try {
    const Hdf5Handle file_space(H5Dget_space(samples_->get()), H5Sclose);
    Check(
        H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, begin.data(), nullptr, shape.data(), nullptr));
    const Hdf5Handle memory_space(H5Screate_simple(2, shape.data(), nullptr), H5Sclose);
    const hid_t type = description_.type == SampleType::kInt32 ? H5T_NATIVE_INT32 : H5T_NATIVE_FLOAT;
    Check(H5Dread(samples_->get(), type, memory_space.get(), file_space.get(), H5P_DEFAULT, words.data()));
  } catch (const Hdf5Error& error) {
    Refuse(fmt::format("dataset 'samples', rows {} to {}: {}", row, row + count - 1, error.what()),
           "the values as they were written");
  }
  return words;
}

std::vector<double> StreamFileReader::Values(std::size_t channel,
                                             const std::optional<Calibration>& calibration) const {
  const Calibration& scale = calibration ? *calibration : description_.channels.at(channel).calibration;
  const std::size_t channels = description_.channels.size();
  std::vector<double> values;
  values.reserve(rows_);
  for (const BlockRow& block : blocks_) {
    const std::vector<std::uint32_t> words = Words(block.row, block.samples);
    for (std::size_t at = channel; at < words.size(); at += channels) {
      values.push_back(scale.Apply(SampleBlock::ValueOf(words[at], description_.type)));
    }
  }
  return values;
}

}  // namespace strainwave::daq::acquisition
