// SPDX-License-Identifier: Apache-2.0
#include "daq/growing_file.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "daq/crc32.h"
#include "daq/data_file_error.h"
#include "daq/record_error.h"
#include "daq/whole_file.h"

namespace strainwave::daq {
namespace {

static_assert(std::endian::native == std::endian::little, "blocks are written in the machine's byte order");

constexpr char kBlockMagic[8] = {'s', 'w', 'r', 'o', 'w', 's', '0', '1'};

// The first checksum covers the header before it, so that a length can be believed; the second the payload.
struct BlockHeader {
  char magic[8];
  std::uint64_t number;
  std::uint64_t payload_bytes;
  std::uint64_t rows;
  std::uint32_t payload_crc32;
  std::uint32_t header_crc32;
};
static_assert(sizeof(BlockHeader) == 40);

std::uint32_t ChecksumOf(const BlockHeader& header) {
  return Crc32(std::as_bytes(std::span(&header, 1)).first(offsetof(BlockHeader, header_crc32)));
}

class Payload {
 public:
  template <typename Number>
  void Add(Number number) {
    static_assert(std::is_trivially_copyable_v<Number>);
    AddBytes(std::as_bytes(std::span(&number, 1)));
  }
  void Add(const std::string& text) {
    Add(std::uint64_t{text.size()});
    AddBytes(std::as_bytes(std::span(text)));
  }
  void Add(const Attributes& texts) {
    Add(std::uint64_t{texts.size()});
    for (const auto& [key, text] : texts) {
      Add(key);
      Add(text);
    }
  }
  void Add(const Column& column, std::size_t first_row) {
    Add(column.name);
    Add(column.sensor_serial);
    Add(column.calibration);
    Add(column.calibration_terms);
    Add(std::uint64_t{column.values.index()});
    std::visit([&](const auto& values) { AddBytes(std::as_bytes(std::span(values).subspan(first_row))); },
               column.values);
  }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  void AddBytes(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  std::vector<std::byte> bytes_;
};

// Throws std::out_of_range where the payload does not hold what it says, which its checksum has ruled out.
class PayloadReader {
 public:
  explicit PayloadReader(std::span<const std::byte> bytes) : left_(bytes) {}

  template <typename Number>
  Number Take() {
    Number number;
    std::memcpy(&number, TakeBytes(sizeof number).data(), sizeof number);
    return number;
  }
  std::string Text() {
    const auto bytes = TakeBytes(Take<std::uint64_t>());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  Attributes Texts() {
    Attributes texts;
    for (auto count = Take<std::uint64_t>(); count > 0; --count) {
      std::string key = Text();
      texts.emplace_back(std::move(key), Text());
    }
    return texts;
  }
  Column TakeColumn(std::size_t rows) {
    Column column;
    column.name = Text();
    column.sensor_serial = Text();
    column.calibration = Text();
    column.calibration_terms = Texts();
    const auto type = Take<std::uint64_t>();
    if (type == 0) column.values = Values<double>(rows);
    if (type == 1) column.values = Values<float>(rows);
    if (type == 2) column.values = Values<Direction>(rows);
    return column;
  }

 private:
  template <typename Value>
  std::vector<Value> Values(std::size_t rows) {
    if (rows > left_.size() / sizeof(Value)) throw std::out_of_range("rows");
    const auto bytes = TakeBytes(rows * sizeof(Value));
    std::vector<Value> values(rows);
    if (rows > 0) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  std::span<const std::byte> TakeBytes(std::uint64_t count) {
    if (count > left_.size()) throw std::out_of_range("bytes");
    const auto taken = left_.first(count);
    left_ = left_.subspan(count);
    return taken;
  }
  std::span<const std::byte> left_;
};

[[noreturn]] void ThrowLast(const char* doing, const std::filesystem::path& path) {
  throw DataFileError(LastError(), doing, path.string());
}

std::optional<BlockHeader> HeaderAt(std::span<const std::byte> bytes) {
  BlockHeader header;
  if (bytes.size() < sizeof header) return std::nullopt;
  std::memcpy(&header, bytes.data(), sizeof header);
  const bool good = std::memcmp(header.magic, kBlockMagic, sizeof kBlockMagic) == 0 &&
                    header.header_crc32 == ChecksumOf(header);
  return good ? std::optional(header) : std::nullopt;
}

bool ABlockBeginsIn(std::span<const std::byte> bytes) {
  for (; bytes.size() >= sizeof(BlockHeader); bytes = bytes.subspan(1)) {
    if (bytes.front() == static_cast<std::byte>(kBlockMagic[0]) && HeaderAt(bytes)) return true;
  }
  return false;
}

void Extend(Column& column, Column&& more, std::size_t first_row) {
  std::visit(
      [&](auto& values) {
        const auto& added = std::get<std::decay_t<decltype(values)>>(more.values);
        values.resize(first_row);
        values.insert(values.end(), added.begin(), added.end());
      },
      column.values);
}

void TakeBlock(std::span<const std::byte> payload, GrownFile& file) {
  PayloadReader reader(payload);
  file.attributes = reader.Texts();
  for (auto count = reader.Take<std::uint64_t>(); count > 0; --count) {
    const std::string group = reader.Text();
    const auto known = std::ranges::find(file.records, group, &NamedRecord::group);
    NamedRecord& named = known == file.records.end() ? file.records.emplace_back() : *known;
    named.group = group;
    named.record.kind = RecordKind::Named(reader.Text());
    named.record.metadata = reader.Texts();
    const auto first_row = reader.Take<std::uint64_t>();
    const auto rows = reader.Take<std::uint64_t>();
    const auto columns = reader.Take<std::uint64_t>();
    // What begins anew may have other columns than before, as a summary has once its channels are there.
    if (first_row == 0) named.record.columns.clear();
    if (first_row > named.record.rows()) throw std::out_of_range("first row");
    for (std::uint64_t i = 0; i < columns; ++i) {
      Column column = reader.TakeColumn(rows);
      if (first_row == 0) {
        named.record.columns.push_back(std::move(column));
      } else {
        Extend(named.record.columns.at(i), std::move(column), first_row);
      }
    }
  }
}

}  // namespace

GrowingFile::GrowingFile(const std::filesystem::path& path, Attributes attributes)
    : path_(path),
      file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)),
      attributes_(std::move(attributes)) {
  if (!file_.is_open()) ThrowLast("cannot write", path_);
  const FileDescriptor folder(::open(path_.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.is_open() || ::fsync(folder.get()) != 0) ThrowLast("cannot sync the folder of", path_);
}

void GrowingFile::DemandSynced() const {
  if (failed_sync_) throw DataFileError(failed_sync_, "cannot sync", path_.string());
}

void GrowingFile::Append(std::span<const NamedRecord> records) {
  DemandSynced();
  Payload payload;
  payload.Add(attributes_);
  payload.Add(std::uint64_t{records.size()});
  std::uint64_t new_rows = 0;
  for (const auto& [group, record] : records) {
    std::size_t& on_disk = rows_[group];
    const std::size_t first_row = record.rows() == 1 ? 0 : on_disk;
    on_disk = record.rows();
    new_rows += on_disk - first_row;
    payload.Add(group);
    payload.Add(std::string(record.kind.name()));
    payload.Add(record.metadata);
    payload.Add(std::uint64_t{first_row});
    payload.Add(std::uint64_t{on_disk - first_row});
    payload.Add(std::uint64_t{record.columns.size()});
    for (const Column& column : record.columns) payload.Add(column, first_row);
  }
  BlockHeader header{.magic = {},
                     .number = ++blocks_,
                     .payload_bytes = payload.bytes().size(),
                     .rows = new_rows,
                     .payload_crc32 = Crc32(payload.bytes()),
                     .header_crc32 = 0};
  std::memcpy(header.magic, kBlockMagic, sizeof kBlockMagic);
  header.header_crc32 = ChecksumOf(header);
  WriteAll(file_.get(), std::as_bytes(std::span(&header, 1)), path_);
  WriteAll(file_.get(), payload.bytes(), path_);
  if (::fdatasync(file_.get()) != 0) failed_sync_ = LastError();
  DemandSynced();
}

GrownFile ReadGrowingFile(const std::filesystem::path& path) {
  const std::string text = ReadWholeFile(path);
  std::span<const std::byte> left = std::as_bytes(std::span(text));
  GrownFile file;
  for (std::uint64_t number = 1; !left.empty(); ++number) {
    const auto header = HeaderAt(left);
    const auto behind = left.subspan(std::min(left.size(), sizeof(BlockHeader)));
    const bool whole = header && header->number == number && header->payload_bytes <= behind.size() &&
                       Crc32(behind.first(header->payload_bytes)) == header->payload_crc32;
    if (!whole) {
      if (ABlockBeginsIn(left.subspan(1))) {
        throw RecordError(path.string(), fmt::format("block {} does not match its checksum", number),
                          "the file as it was written");
      }
      file.lost_bytes = left.size();
      return file;
    }
    try {
      TakeBlock(behind.first(header->payload_bytes), file);
    } catch (const std::exception&) {
      throw RecordError(path.string(), fmt::format("block {} has another form than it says", number),
                        "the file as it was written");
    }
    left = behind.subspan(header->payload_bytes);
  }
  return file;
}

}  // namespace strainwave::daq
