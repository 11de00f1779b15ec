// SPDX-License-Identifier: Apache-2.0
#include "daq/hdf5_column.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "daq/csv_text.h"
#include "daq/direction_words.h"
#include "daq/hdf5_attributes.h"
#include "daq/hdf5_handle.h"
#include "daq/hdf5_text.h"
#include "daq/record_limits.h"
#include "daq/record_rules.h"
#include "daq/value_bounds.h"

namespace strainwave::daq {
namespace {

constexpr hsize_t kMostRowsPerChunk = 65536;
constexpr std::size_t kMostTroubles = kMostBreaksPerColumn;
constexpr std::size_t kDirectionWidth = 3;
constexpr int kDeflateLevel = 1;  // 6 takes 3 % less room and twice the time

// The names of `FORMAT.md`; which calibration and of which sensor stand in columns of their own.
bool IsCalibrationTerm(std::string_view name) {
  constexpr std::string_view kNames[] = {"sensitivity", "zero", "polynomial", "calibration_date",
                                         "calibration_due"};
  return std::ranges::find(kNames, name) != std::end(kNames);
}

Hdf5Handle CreateDirectionType() {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  Check(H5Tset_size(type.get(), kDirectionWidth));
  Check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD));
  return type;
}

struct Layout {
  hid_t file_type;
  hid_t memory_type;
  std::span<const std::byte> values;  // of one size in memory and in the file
  const void* fill;                   // of the memory type; null: zeros
};

// By the first values. Noise of sensors keeps 86 % of its size and takes three quarters of the time of all
// columns of a cycle; times, angles and directions keep 2 to 60 %.
bool PaysToDeflate(std::span<const std::byte> values, std::size_t width) {
  constexpr std::size_t kLeast_bytes = 512;  // what the filters add to a dataset is a tenth of that
  constexpr std::size_t kSampledRows = 4096;
  constexpr double kMostShare = 0.8;
  if (values.size() < kLeast_bytes) return false;
  const std::size_t rows = std::min(values.size() / width, kSampledRows);
  std::vector<std::byte> shuffled;
  shuffled.reserve(rows * width);
  for (std::size_t byte = 0; byte < width; ++byte) {
    for (std::size_t row = 0; row < rows; ++row) shuffled.push_back(values[row * width + byte]);
  }
  uLongf deflated_bytes = compressBound(shuffled.size());
  std::vector<Bytef> deflated(deflated_bytes);
  const int result =
      compress2(deflated.data(), &deflated_bytes, reinterpret_cast<const Bytef*>(shuffled.data()),
                shuffled.size(), kDeflateLevel);
  return result == Z_OK &&
         static_cast<double>(deflated_bytes) <= kMostShare * static_cast<double>(shuffled.size());
}

Hdf5Handle WriteDataset(hid_t group, const Column& column, const Layout& layout, Packing packing) {
  const auto rows = static_cast<hsize_t>(column.size());
  const Hdf5Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
  const Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const hsize_t chunk = std::min(rows, kMostRowsPerChunk);
  Check(H5Pset_chunk(properties.get(), 1, &chunk));
  if (packing == Packing::kDeflated && PaysToDeflate(layout.values, layout.values.size() / rows)) {
    Check(H5Pset_shuffle(properties.get()));
    Check(H5Pset_deflate(properties.get(), kDeflateLevel));
  }
  // Last, so that the checksum is of the bytes in the file.
  Check(H5Pset_fletcher32(properties.get()));
  if (layout.fill != nullptr) Check(H5Pset_fill_value(properties.get(), layout.memory_type, layout.fill));
  Check(H5Pset_obj_track_times(properties.get(), false));  // the same record gives the same bytes
  constexpr std::size_t kOwnAttributes = 4;                // unit, sensor, calibration, rate
  KeepAttributesInHeader(properties.get(), kOwnAttributes + column.calibration_terms.size());
  Hdf5Handle dataset(H5Dcreate2(group, column.name.c_str(), layout.file_type, space.get(), H5P_DEFAULT,
                                properties.get(), H5P_DEFAULT),
                     H5Dclose);
  Check(H5Dwrite(dataset.get(), layout.memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, layout.values.data()));
  return dataset;
}

Hdf5Handle WriteValues(hid_t group, const Column& column, Packing packing) {
  // A chunk that went missing must not read as good zeros. NaN shows in every tool.
  if (const auto* doubles = std::get_if<std::vector<double>>(&column.values)) {
    const double fill = std::numeric_limits<double>::quiet_NaN();
    return WriteDataset(group, column,
                        {H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, std::as_bytes(std::span(*doubles)), &fill},
                        packing);
  }
  if (const auto* floats = std::get_if<std::vector<float>>(&column.values)) {
    const float fill = std::numeric_limits<float>::quiet_NaN();
    return WriteDataset(
        group, column, {H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, std::as_bytes(std::span(*floats)), &fill}, packing);
  }
  const auto& directions = std::get<std::vector<Direction>>(column.values);
  std::vector<std::array<char, kDirectionWidth>> texts;
  texts.reserve(directions.size());
  for (const Direction direction : directions) {
    texts.push_back(direction == Direction::kClockwise ? std::array{'c', 'w', '\0'}
                                                       : std::array{'c', 'c', 'w'});
  }
  // netCDF crashes on a fill value of a text, even of zeros (findings/netcdf-text-fill.sh).
  const Hdf5Handle type = CreateDirectionType();
  return WriteDataset(group, column, {type.get(), type.get(), std::as_bytes(std::span(texts)), nullptr},
                      packing);
}

// Reading a part of a dataset that was never written gives its fill value, zeros as a rule: invented data.
bool HoldsAllValues(hid_t dataset, hid_t space) {
  const Hdf5Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  switch (H5Pget_layout(properties.get())) {
    case H5D_CHUNKED: {
      std::array<hsize_t, H5S_MAX_RANK> chunk{};
      std::array<hsize_t, H5S_MAX_RANK> extent{};
      const int rank = Check(H5Pget_chunk(properties.get(), H5S_MAX_RANK, chunk.data()));
      Check(H5Sget_simple_extent_dims(space, extent.data(), nullptr));
      hsize_t expected = 1;
      for (std::size_t i = 0; i < static_cast<std::size_t>(rank); ++i) {
        expected *= (extent[i] + chunk[i] - 1) / chunk[i];
      }
      hsize_t present{};
      Check(H5Dget_num_chunks(dataset, space, &present));
      return present >= expected;
    }
    case H5D_CONTIGUOUS:
      return H5Dget_storage_size(dataset) > 0 && H5Pget_external_count(properties.get()) == 0;
    case H5D_COMPACT:
      return true;
    default:
      return false;  // virtual: the values are in other files
  }
}

// What is in the way of reading so many values: a few stored bytes that become very many, in a chunk or in
// all.
std::optional<ColumnTrouble> TooLarge(hid_t dataset, const std::string& name, std::size_t rows) {
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  const std::size_t width = std::max(H5Tget_size(type.get()), sizeof(double));
  if (rows > kMostValues || width > kMostLine_bytes) {
    return ColumnTrouble{
        std::nullopt, fmt::format("{} has {} values of {} bytes", name, rows, width),
        fmt::format("at most {} of at most {}: a file a part of the time", kMostValues, kMostLine_bytes)};
  }
  std::size_t decoded_bytes = rows * width;
  const Hdf5Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  if (H5Pget_layout(properties.get()) == H5D_CHUNKED) {
    std::array<hsize_t, H5S_MAX_RANK> chunk{};
    const int rank = Check(H5Pget_chunk(properties.get(), H5S_MAX_RANK, chunk.data()));
    std::size_t chunk_bytes = width;
    for (std::size_t i = 0; i < static_cast<std::size_t>(rank); ++i) chunk_bytes *= chunk[i];
    decoded_bytes = std::max(decoded_bytes, chunk_bytes);
  }
  const std::size_t stored_bytes = H5Dget_storage_size(dataset);
  if (decoded_bytes <= kHarmless_bytes || decoded_bytes / kMostInflation <= stored_bytes) return std::nullopt;
  return ColumnTrouble{std::nullopt,
                       fmt::format("{} becomes {} bytes out of {}", name, decoded_bytes, stored_bytes),
                       fmt::format("at most {} times as many, as measured values do", kMostInflation)};
}

// Rows of a dataset that is a column, of one dimension that counts; nothing otherwise.
std::optional<std::size_t> RowsOf(hid_t space) {
  if (H5Sget_simple_extent_type(space) != H5S_SIMPLE) return std::nullopt;
  std::array<hsize_t, H5S_MAX_RANK> extent{};
  const int rank = Check(H5Sget_simple_extent_dims(space, extent.data(), nullptr));
  hsize_t rows = 1;
  int long_dimensions = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(rank); ++i) {
    if (extent[i] == 1) continue;
    ++long_dimensions;
    rows = extent[i];
  }
  if (rank == 0 || long_dimensions > 1) return std::nullopt;
  return static_cast<std::size_t>(rows);
}

std::optional<Direction> DirectionIn(double number) { return DirectionOf(number); }
std::optional<Direction> DirectionIn(const std::string& text) { return DirectionOf(std::string_view(text)); }
std::optional<Direction> DirectionIn(const NamedValue& value) {
  const std::optional<Direction> by_name = DirectionOf(std::string_view(value.name));
  return by_name ? by_name : DirectionOf(static_cast<double>(value.number));
}

std::string Describe(double number) { return ShortestText(number); }
std::string Describe(const std::string& text) { return Quoted(text); }
std::string Describe(const NamedValue& value) {
  return value.name.empty() ? std::to_string(value.number) : Quoted(value.name);
}

template <typename Value>
void TakeDirections(const std::vector<Value>& values, ReadColumnResult& result) {
  std::vector<Direction> directions;
  directions.reserve(values.size());
  for (std::size_t row = 0; row < values.size(); ++row) {
    const std::optional<Direction> direction = DirectionIn(values[row]);
    directions.push_back(direction.value_or(Direction::kClockwise));
    if (direction || result.troubles.size() >= kMostTroubles) continue;
    result.troubles.push_back({row, fmt::format("{} is {}", result.column.name, Describe(values[row])),
                               std::string(kDirectionWords)});
  }
  result.column.values = std::move(directions);
}

template <typename Number>
std::vector<Number> ReadNumbers(const Hdf5Values& values, hid_t memory_type) {
  std::vector<Number> numbers(values.count);
  values.Read(memory_type, numbers.data());
  return numbers;
}

void ReadValues(const Hdf5Values& values, ColumnType type, ReadColumnResult& result) {
  const H5T_class_t type_class = H5Tget_class(values.type);
  const bool is_number = type_class == H5T_FLOAT || type_class == H5T_INTEGER;
  if (type == ColumnType::kDirection && type_class == H5T_STRING) {
    TakeDirections(ReadTexts(values), result);
  } else if (type == ColumnType::kDirection && type_class == H5T_ENUM) {
    TakeDirections(ReadNamedValues(values), result);
  } else if (type == ColumnType::kDirection && is_number) {
    TakeDirections(ReadNumbers<double>(values, H5T_NATIVE_DOUBLE), result);
  } else if (!is_number) {
    result.troubles.push_back({std::nullopt, result.column.name + " does not hold numbers",
                               type == ColumnType::kDirection ? "cw and ccw as text" : "floats or integers"});
  } else if (type == ColumnType::kFloatIfStoredSo && type_class == H5T_FLOAT &&
             H5Tget_size(values.type) <= sizeof(float)) {
    result.column.values = ReadNumbers<float>(values, H5T_NATIVE_FLOAT);
  } else {
    result.column.values = ReadNumbers<double>(values, H5T_NATIVE_DOUBLE);
  }
}

// Filters of others, by their numbers in the list of the HDF Group, and who brings them.
std::string NameOfFilter(H5Z_filter_t filter) {
  switch (filter) {
    case H5Z_FILTER_SZIP:
      return "szip";
    case 307:
      return "bzip2, which needs a plug-in";
    case 32000:
      return "LZF, which needs h5py";
    case 32001:
      return "Blosc, which needs a plug-in";
    case 32004:
      return "LZ4, which needs a plug-in";
    case 32008:
      return "bitshuffle, which needs a plug-in";
    case 32013:
      return "ZFP, which needs a plug-in";
    case 32015:
      return "Zstandard, which needs a plug-in";
    case 32026:
      return "Blosc2, which needs a plug-in";
    default:
      return fmt::format("filter {} of HDF5, which needs a plug-in", filter);
  }
}

// The library itself speaks of its folder of plug-ins.
ColumnTrouble WhyUnreadable(hid_t dataset, const Hdf5Error& error) {
  const std::string what = fmt::format("HDF5 cannot read it: {}", error.what());
  const Hdf5Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  const int filters = H5Pget_nfilters(properties.get());
  for (int i = 0; i < filters; ++i) {
    std::size_t values = 0;
    unsigned flags{};
    unsigned config{};
    const H5Z_filter_t filter = H5Pget_filter2(properties.get(), static_cast<unsigned>(i), &flags, &values,
                                               nullptr, 0, nullptr, &config);
    if (filter < 0 || H5Zfilter_avail(filter) > 0) continue;
    return {std::nullopt, "compressed with " + NameOfFilter(filter),
            "gzip or none, as after h5repack -f GZIP=4"};
  }
  return {std::nullopt, what, "the values as they were written"};
}

void ReadAllValues(hid_t dataset, hid_t type_in_file, const std::string& member, ColumnType type,
                   ReadColumnResult& result) {
  const std::string& name = result.column.name;
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  const std::optional<std::size_t> rows = RowsOf(space.get());
  if (!rows) {
    result.troubles.push_back({std::nullopt, name + " is not one-dimensional", "a column of values"});
    return;
  }
  if (*rows == 0) return;
  if (!HoldsAllValues(dataset, space.get())) {
    result.troubles.push_back({std::nullopt, name + " has values missing that were never written",
                               "as many values stored as there are rows"});
    return;
  }
  if (std::optional<ColumnTrouble> trouble = TooLarge(dataset, name, *rows)) {
    result.troubles.push_back(std::move(*trouble));
    return;
  }
  try {
    ReadValues({type_in_file, space.get(), *rows, false, dataset, member}, type, result);
  } catch (const Hdf5Error& error) {
    result.troubles.push_back(WhyUnreadable(dataset, error));
  }
}

}  // namespace

void WriteColumn(hid_t group, const Column& column, const std::optional<std::string>& sample_rate_hz,
                 Packing packing) {
  const Hdf5Handle dataset = WriteValues(group, column, packing);
  const auto write_text = [&dataset](const char* name, const std::string& text) {
    if (!text.empty()) WriteTextAttribute(dataset.get(), name, text);
  };
  write_text("unit", UnitOf(column.name));
  // As text, even where all letters are digits: a serial number is a name.
  write_text("sensor_serial", column.sensor_serial);
  write_text("calibration", column.calibration);
  for (const auto& [name, text] : column.calibration_terms) {
    if (IsCalibrationTerm(name)) WriteAttribute(dataset.get(), name.c_str(), text);
  }
  if (sample_rate_hz) WriteAttribute(dataset.get(), "sample_rate_hz", *sample_rate_hz);
}

ReadColumnResult ReadColumn(hid_t dataset, const std::string& name, ColumnType type, bool described) {
  ReadColumnResult result;
  result.column.name = name;
  std::vector<std::string> left_out;
  const auto attributes = described ? ReadAttributes(dataset, left_out) : std::vector<Hdf5Attribute>();
  for (const Hdf5Attribute& attribute : attributes) {
    if (attribute.name == "sensor_serial") result.column.sensor_serial = attribute.text;
    if (attribute.name == "calibration") result.column.calibration = attribute.text;
    if (IsCalibrationTerm(attribute.name)) {
      result.column.calibration_terms.emplace_back(attribute.name, attribute.text);
    }
  }
  const Hdf5Handle file_type(H5Dget_type(dataset), H5Tclose);
  ReadAllValues(dataset, file_type.get(), "", type, result);
  return result;
}

std::vector<std::string> MembersOf(hid_t dataset) {
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  std::vector<std::string> names;
  if (H5Tget_class(type.get()) != H5T_COMPOUND) return names;
  const auto count = static_cast<unsigned>(Check(H5Tget_nmembers(type.get())));
  if (count > kMostColumns) {
    throw Hdf5Error(fmt::format("a dataset has rows of {} values (at most {})", count, kMostColumns));
  }
  for (unsigned i = 0; i < count; ++i) {
    const std::unique_ptr<char, herr_t (*)(void*)> name(H5Tget_member_name(type.get(), i), H5free_memory);
    if (name != nullptr) names.emplace_back(name.get());
  }
  return names;
}

ReadColumnResult ReadMember(hid_t dataset, const std::string& member, ColumnType type) {
  ReadColumnResult result;
  result.column.name = member;
  const Hdf5Handle row_type(H5Dget_type(dataset), H5Tclose);
  const auto index = static_cast<unsigned>(Check(H5Tget_member_index(row_type.get(), member.c_str())));
  const Hdf5Handle member_type(H5Tget_member_type(row_type.get(), index), H5Tclose);
  ReadAllValues(dataset, member_type.get(), member, type, result);
  return result;
}

}  // namespace strainwave::daq
