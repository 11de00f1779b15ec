// SPDX-License-Identifier: Apache-2.0
#include "bench/records/record_reader.h"

#include <utility>

#include <fmt/format.h>

#include "bench/records/map_file.h"
#include "daq/read_records.h"
#include "daq/record_error.h"
#include "daq/record_pipe.h"

namespace strainwave::bench {
namespace {

std::vector<daq::Record> InOwnProcess(const std::filesystem::path& path,
                                      const std::function<daq::Record()>& read) {
  const std::string reader = fmt::format("the reader for {}", daq::NameOf(daq::ForeignFormatOf(path)));
  return daq::ReadInOwnProcess(
      path, daq::LimitsForFile(path),
      [&] {
        std::vector<daq::Record> records;
        records.push_back(read());
        return records;
      },
      reader);
}

daq::Record ReadByOwnNames(const std::filesystem::path& path) {
  daq::ForeignFile file = daq::ReadForeignFile(path);
  const std::optional<daq::RecordMap> map = daq::OwnNames(file);
  if (!map)
    throw daq::RecordError(
        path.string(), fmt::format("is {}, which does not say what its series mean", file.format),
        fmt::format("--map FILE; strainwave convert {} --preview shows what is in it", path.string()));
  return daq::MapRecord(std::move(file), *map, path.string());
}

}  // namespace

RecordReader::RecordReader(const std::filesystem::path& map_file) {
  if (!map_file.empty()) map_ = ReadMapFile(map_file);
}

std::vector<daq::Record> RecordReader::Read(const std::filesystem::path& path) const {
  if (map_)
    return InOwnProcess(path,
                        [&] { return daq::MapRecord(daq::ReadForeignFile(path), *map_, path.string()); });
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none))
    return daq::ReadRecords(path);  // which says what is wrong
  const daq::ForeignFormat format = daq::ForeignFormatOf(path);
  if (format == daq::ForeignFormat::kCsv || format == daq::ForeignFormat::kHdf5)
    return daq::ReadRecords(path);
  return InOwnProcess(path, [&] { return ReadByOwnNames(path); });
}

std::vector<std::string> PreviewOfFile(const std::filesystem::path& path) {
  const std::vector<daq::Record> records = InOwnProcess(path, [&] {
    daq::Record lines;
    for (std::string& line : daq::PreviewOf(daq::ReadForeignFile(path)))
      lines.notes.push_back({0, std::move(line)});
    return lines;
  });
  std::vector<std::string> lines;
  for (const daq::RecordNote& note : records.front().notes) lines.push_back(note.text);
  return lines;
}

}  // namespace strainwave::bench
