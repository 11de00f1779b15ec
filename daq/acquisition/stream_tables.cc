// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/stream_tables.h"

#include <cstddef>
#include <span>

namespace strainwave::daq::acquisition {
namespace {

struct Field {
  const char* name;
  std::size_t offset;
  hid_t memory;
  hid_t file;
};

Hdf5Handle RowType(std::size_t size, std::span<const Field> fields, bool packed) {
  std::size_t packed_size = 0;
  for (const Field& field : fields) packed_size += H5Tget_size(field.file);
  Hdf5Handle type(H5Tcreate(H5T_COMPOUND, packed ? packed_size : size), H5Tclose);
  std::size_t at = 0;
  for (const Field& field : fields) {
    Check(H5Tinsert(type.get(), field.name, packed ? at : field.offset, packed ? field.file : field.memory));
    at += H5Tget_size(field.file);
  }
  return type;
}

}  // namespace

BlockRow RowOf(const BlockHeader& header, std::uint64_t row) {
  return {row,
          header.first_sample,
          header.device_counter,
          header.lost_before,
          header.device_time.count(),
          header.arrival.count(),
          header.samples,
          header.flags};
}

GapRow RowOf(const Gap& gap, std::uint64_t row) {
  return {row,
          gap.first_lost,
          gap.lost,
          gap.last_arrival.count(),
          gap.arrival.count(),
          gap.last_device_time.count(),
          gap.device_time.count(),
          static_cast<std::uint8_t>(gap.is_exact),
          static_cast<std::uint8_t>(gap.is_reset)};
}

Hdf5Handle BlockRowType(bool packed) {
  const hid_t u64 = H5T_NATIVE_UINT64, i64 = H5T_NATIVE_INT64, u32 = H5T_NATIVE_UINT32;
  const hid_t u64_le = H5T_STD_U64LE, i64_le = H5T_STD_I64LE, u32_le = H5T_STD_U32LE;
  const Field fields[] = {
      {"row", offsetof(BlockRow, row), u64, u64_le},
      {"first_sample", offsetof(BlockRow, first_sample), u64, u64_le},
      {"device_counter", offsetof(BlockRow, device_counter), u64, u64_le},
      {"lost_before", offsetof(BlockRow, lost_before), u64, u64_le},
      {"device_time_ns", offsetof(BlockRow, device_time_ns), i64, i64_le},
      {"arrival_ns", offsetof(BlockRow, arrival_ns), i64, i64_le},
      {"samples", offsetof(BlockRow, samples), u32, u32_le},
      {"flags", offsetof(BlockRow, flags), u32, u32_le},
  };
  return RowType(sizeof(BlockRow), fields, packed);
}

Hdf5Handle GapRowType(bool packed) {
  const hid_t u64 = H5T_NATIVE_UINT64, i64 = H5T_NATIVE_INT64, u8 = H5T_NATIVE_UINT8;
  const hid_t u64_le = H5T_STD_U64LE, i64_le = H5T_STD_I64LE, u8_le = H5T_STD_U8LE;
  const Field fields[] = {
      {"row", offsetof(GapRow, row), u64, u64_le},
      {"first_lost", offsetof(GapRow, first_lost), u64, u64_le},
      {"lost", offsetof(GapRow, lost), u64, u64_le},
      {"last_arrival_ns", offsetof(GapRow, last_arrival_ns), i64, i64_le},
      {"arrival_ns", offsetof(GapRow, arrival_ns), i64, i64_le},
      {"last_device_time_ns", offsetof(GapRow, last_device_time_ns), i64, i64_le},
      {"device_time_ns", offsetof(GapRow, device_time_ns), i64, i64_le},
      {"is_exact", offsetof(GapRow, is_exact), u8, u8_le},
      {"is_reset", offsetof(GapRow, is_reset), u8, u8_le},
  };
  return RowType(sizeof(GapRow), fields, packed);
}

}  // namespace strainwave::daq::acquisition
