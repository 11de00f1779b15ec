// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/stream_file_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <limits>
#include <set>
#include <stdexcept>

#include "daq/acquisition/stream_tables.h"
#include "daq/data_file_error.h"
#include "daq/file_descriptor.h"
#include "daq/hdf5_attributes.h"
#include "daq/record.h"

namespace strainwave::daq::acquisition {
namespace {

constexpr hsize_t kChunk_bytes = hsize_t{1} << 20;
constexpr hsize_t kTableChunkRows = 1024;
constexpr std::size_t kChunkCache_bytes = std::size_t{4} << 20;
constexpr std::size_t kChunkCacheSlots = 521;
constexpr double kEvictWhatIsFull = 1.0;

void DemandChannels(const SourceDescription& source) {
  if (source.channels.empty()) throw std::invalid_argument("the source has no channels");
  std::set<std::string> names;
  for (const ChannelDescription& channel : source.channels) {
    if (channel.name.empty() || channel.name.find('/') != std::string::npos || channel.name == ".") {
      throw std::invalid_argument(fmt::format("'{}' cannot name a channel in a file", channel.name));
    }
    if (!names.insert(channel.name).second) {
      throw std::invalid_argument(fmt::format("two channels have the name '{}'", channel.name));
    }
  }
}

Hdf5Handle CreateFile(const std::filesystem::path& path) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  Check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110));
  Check(H5Pset_file_locking(access.get(), false, true));
  const Hdf5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  Check(H5Pset_link_creation_order(creation.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  Check(H5Pset_attr_creation_order(creation.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  Check(H5Pset_obj_track_times(creation.get(), false));
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose};
}

// `columns` 0 is a table of one dimension.
Hdf5Handle CreateGrowing(hid_t file, const char* name, hid_t type, hsize_t columns, hsize_t chunk_rows,
                         const void* fill, hid_t fill_type) {
  const int rank = columns == 0 ? 1 : 2;
  const std::array<hsize_t, 2> none{0, columns};
  const std::array<hsize_t, 2> most{H5S_UNLIMITED, columns};
  const std::array<hsize_t, 2> chunk{chunk_rows, columns};
  const Hdf5Handle space(H5Screate_simple(rank, none.data(), most.data()), H5Sclose);
  const Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  Check(H5Pset_chunk(properties.get(), rank, chunk.data()));
  Check(H5Pset_fletcher32(properties.get()));
  Check(H5Pset_obj_track_times(properties.get(), false));
  if (fill != nullptr) Check(H5Pset_fill_value(properties.get(), fill_type, fill));
  const Hdf5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  Check(H5Pset_chunk_cache(access.get(), kChunkCacheSlots, kChunkCache_bytes, kEvictWhatIsFull));
  return {H5Dcreate2(file, name, type, space.get(), H5P_DEFAULT, properties.get(), access.get()), H5Dclose};
}

Hdf5Handle CreateSamples(hid_t file, SampleType type, hsize_t channels) {
  const hsize_t rows = std::max<hsize_t>(1, kChunk_bytes / (channels * sizeof(std::uint32_t)));
  // A chunk that went missing must not read as good zeros.
  if (type == SampleType::kInt32) {
    const std::int32_t fill = std::numeric_limits<std::int32_t>::min();
    return CreateGrowing(file, "samples", H5T_STD_I32LE, channels, rows, &fill, H5T_NATIVE_INT32);
  }
  const float fill = std::numeric_limits<float>::quiet_NaN();
  return CreateGrowing(file, "samples", H5T_IEEE_F32LE, channels, rows, &fill, H5T_NATIVE_FLOAT);
}

Hdf5Handle NativeType(SampleType type) {
  return {H5Tcopy(type == SampleType::kInt32 ? H5T_NATIVE_INT32 : H5T_NATIVE_FLOAT), H5Tclose};
}

void WriteHead(hid_t file, const SourceDescription& source, const Attributes& attributes) {
  WriteSoftware(file);
  WriteAttribute(file, "strainwave_stream", "1");
  WriteTextAttribute(file, "source", source.name);
  WriteAttribute(file, "source_number", std::to_string(source.source));
  WriteAttribute(file, "rate_hz", ShortestText(source.rate_hz));
  WriteAttribute(file, "counter_bits", std::to_string(source.counter_bits));
  for (const auto& [name, text] : attributes) WriteAttribute(file, name, text);
}

void WriteChannels(hid_t file, const SourceDescription& source) {
  const Hdf5Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  Check(H5Pset_link_creation_order(creation.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  Check(H5Pset_attr_creation_order(creation.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  const Hdf5Handle channels(H5Gcreate2(file, "channels", H5P_DEFAULT, creation.get(), H5P_DEFAULT), H5Gclose);
  for (std::size_t i = 0; i < source.channels.size(); ++i) {
    const ChannelDescription& channel = source.channels[i];
    const Hdf5Handle group(
        H5Gcreate2(channels.get(), channel.name.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT), H5Gclose);
    WriteAttribute(group.get(), "column", std::to_string(i));
    WriteTextAttribute(group.get(), "unit", channel.unit);
    if (!channel.sensor_serial.empty()) {
      WriteTextAttribute(group.get(), "sensor_serial", channel.sensor_serial);
    }
    for (const auto& [name, text] : AttributesOf(channel.calibration))
      WriteAttribute(group.get(), name, text);
  }
}

[[noreturn]] void ThrowErrno(const char* doing, const std::filesystem::path& path) {
  throw DataFileError({errno, std::generic_category()}, doing, path.string());
}

void Sync(const std::filesystem::path& path, int flags) {
  const FileDescriptor file(::open(path.c_str(), flags | O_CLOEXEC));
  if (!file.is_open() || ::fsync(file.get()) != 0) ThrowErrno("cannot sync", path);
}

}  // namespace

// HDF5 says in words what a disk refused, but keeps no errno; the one that it left behind is the best there
// is.
template <typename Call>
void StreamFileWriter::Guarded(const char* doing, Call call) {
  const Hdf5Silence silence;
  errno = 0;
  try {
    call();
  } catch (const Hdf5Error& error) {
    throw DataFileError({errno == 0 ? EIO : errno, std::generic_category()},
                        fmt::format("{} ({})", doing, error.what()), partial_.string());
  }
}

StreamFileWriter::StreamFileWriter(std::filesystem::path path, const SourceDescription& source,
                                   const Attributes& attributes)
    : path_(std::move(path)),
      partial_(path_.parent_path() / fmt::format(".{}.partial", path_.filename().string())),
      type_(source.type),
      channels_(static_cast<std::uint32_t>(source.channels.size())) {
  DemandChannels(source);
  Guarded("cannot create", [&] {
    file_.emplace(CreateFile(partial_));
    WriteHead(file_->get(), source, attributes);
    WriteChannels(file_->get(), source);
    samples_.emplace(Table{CreateSamples(file_->get(), type_, channels_), NativeType(type_)});
    blocks_.emplace(Table{CreateGrowing(file_->get(), "blocks", BlockRowType(true).get(), 0, kTableChunkRows,
                                        nullptr, H5I_INVALID_HID),
                          BlockRowType(false)});
    gaps_.emplace(Table{CreateGrowing(file_->get(), "gaps", GapRowType(true).get(), 0, kTableChunkRows,
                                      nullptr, H5I_INVALID_HID),
                        GapRowType(false)});
    // From here on the structure stands and only rows are added.
    Check(H5Fstart_swmr_write(file_->get()));
  });
}

StreamFileWriter::~StreamFileWriter() {
  // What HDF5 cannot write any more it complains about while it closes.
  const Hdf5Silence silence;
  gaps_.reset();
  blocks_.reset();
  samples_.reset();
  file_.reset();
}

void StreamFileWriter::AppendRows(Table& table, const void* rows, std::uint64_t count,
                                  std::uint32_t channels) {
  const int rank = channels == 0 ? 1 : 2;
  const std::array<hsize_t, 2> extent{table.rows + count, channels};
  const std::array<hsize_t, 2> begin{table.rows, 0};
  const std::array<hsize_t, 2> shape{count, channels};
  Check(H5Dset_extent(table.dataset.get(), extent.data()));
  const Hdf5Handle file_space(H5Dget_space(table.dataset.get()), H5Sclose);
  Check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, begin.data(), nullptr, shape.data(), nullptr));
  const Hdf5Handle memory_space(H5Screate_simple(rank, shape.data(), nullptr), H5Sclose);
  Check(H5Dwrite(table.dataset.get(), table.memory_type.get(), memory_space.get(), file_space.get(),
                 H5P_DEFAULT, rows));
  table.rows += count;
}

void StreamFileWriter::Append(const SampleBlock& block, const std::optional<Gap>& gap) {
  const BlockHeader& header = block.header;
  if (header.channels != channels_ || header.type != type_) {
    throw std::invalid_argument(fmt::format("a block of {} channels does not belong in '{}', which has {}{}",
                                            header.channels, path_.string(), channels_,
                                            header.type != type_ ? " of another type" : ""));
  }
  if (gap) AppendGap(*gap);
  if (header.samples == 0) return;
  Guarded("cannot write", [&] {
    AppendRows(*samples_, block.words().data(), header.samples, channels_);
    const BlockRow row = RowOf(header, rows_);
    AppendRows(*blocks_, &row, 1, 0);
    rows_ += header.samples;
  });
}

void StreamFileWriter::AppendGap(const Gap& gap) {
  Guarded("cannot write", [&] {
    const GapRow row = RowOf(gap, rows_);
    AppendRows(*gaps_, &row, 1, 0);
  });
}

void StreamFileWriter::Flush() {
  Guarded("cannot write", [this] {
    // Samples first: a reader that finds a block in the table finds its samples too.
    Check(H5Dflush(samples_->dataset.get()));
    Check(H5Dflush(gaps_->dataset.get()));
    Check(H5Dflush(blocks_->dataset.get()));
  });
}

void StreamFileWriter::Close() {
  Flush();
  Guarded("cannot close", [this] {
    gaps_.reset();
    blocks_.reset();
    samples_.reset();
    Check(H5Fflush(file_->get(), H5F_SCOPE_GLOBAL));
    file_.reset();
  });
  Sync(partial_, O_RDONLY);
  if (::rename(partial_.c_str(), path_.c_str()) != 0) ThrowErrno("cannot rename the finished file to", path_);
  Sync(path_.has_parent_path() ? path_.parent_path() : std::filesystem::path("."), O_RDONLY | O_DIRECTORY);
}

}  // namespace strainwave::daq::acquisition
