// SPDX-License-Identifier: Apache-2.0
#include "daq/import/foreign_file.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "daq/csv_text.h"
#include "daq/record_error.h"

namespace strainwave::daq {
namespace {

constexpr std::string_view kHdf5Signature = "\x89HDF\r\n\x1a\n";
constexpr std::size_t kMatHeader_bytes = 512;  // behind it a MAT 7.3 file is HDF5

// A universal file begins with a line that is -1 alone.
bool BeginsAsUff(std::string_view head) {
  while (!head.empty()) {
    const std::string_view line = Trim(TakeLine(head).text);
    if (!line.empty()) return line == "-1";
  }
  return false;
}

}  // namespace

ForeignFormat ForeignFormatOf(const std::filesystem::path& path) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) throw RecordError(path.string(), "is a folder", "a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw RecordError(path.string(), "cannot be opened", "a file that can be read");
  std::array<char, kMatHeader_bytes + kHdf5Signature.size()> bytes{};
  file.read(bytes.data(), bytes.size());
  const std::string_view head(bytes.data(), static_cast<std::size_t>(file.gcount()));
  if (head.starts_with("MATLAB 5.0 MAT-file")) return ForeignFormat::kMat5;
  if (head.size() > kMatHeader_bytes && head.substr(kMatHeader_bytes) == kHdf5Signature)
    return head.starts_with("MATLAB 7.3") ? ForeignFormat::kMat73 : ForeignFormat::kHdf5;
  if (head.starts_with(kHdf5Signature)) return ForeignFormat::kHdf5;
  if (head.starts_with("TDSm")) return ForeignFormat::kTdms;
  if (head.starts_with("fLaC") || head.starts_with("RF64") ||
      (head.starts_with("RIFF") && head.size() > 12 && head.substr(8, 4) == "WAVE"))
    return ForeignFormat::kAudio;
  if (BeginsAsUff(head)) return ForeignFormat::kUff;
  return ForeignFormat::kCsv;
}

std::string NameOf(ForeignFormat format) {
  switch (format) {
    case ForeignFormat::kCsv:
      return "CSV";
    case ForeignFormat::kHdf5:
      return "HDF5";
    case ForeignFormat::kMat5:
      return "MAT 5";
    case ForeignFormat::kMat73:
      return "MAT 7.3";
    case ForeignFormat::kUff:
      return "UFF 58";
    case ForeignFormat::kTdms:
      return "TDMS";
    case ForeignFormat::kAudio:
      return "audio";
  }
  return "";
}

ForeignFile ReadForeignFile(const std::filesystem::path& path) {
  ForeignFile file;
  switch (ForeignFormatOf(path)) {
    case ForeignFormat::kCsv:
      file = ReadCsvChannels(path);
      break;
    case ForeignFormat::kHdf5:
      file = ReadHdf5Channels(path);
      break;
    case ForeignFormat::kMat5:
    case ForeignFormat::kMat73:
      file = ReadMatFile(path);
      break;
    case ForeignFormat::kUff:
      file = ReadUffFile(path);
      break;
    case ForeignFormat::kTdms:
      file = ReadTdmsFile(path);
      break;
    case ForeignFormat::kAudio:
      file = ReadAudioFile(path);
      break;
  }
  MakeNamesUnique(file);
  return file;
}

void MakeNamesUnique(ForeignFile& file) {
  std::set<std::string> taken;
  for (const ForeignChannel& channel : file.channels) taken.insert(channel.name);
  std::map<std::string, int> met;
  for (ForeignChannel& channel : file.channels) {
    const std::string original = channel.name;
    int& count = met[original];
    if (++count == 1) continue;
    do {
      channel.name = fmt::format("{} #{}", original, count);
    } while (!taken.insert(channel.name).second && ++count > 0);
  }
}

}  // namespace strainwave::daq
