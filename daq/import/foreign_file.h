// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// What other programs and instruments wrote, before anybody has said what it means.
namespace strainwave::daq {

/// One series of a file: numbers, or words such as cw and ccw.
struct ForeignChannel {
  std::string name;  // unique in the file
  std::string unit;  // as the file has it; empty where it says none
  std::vector<double> values;
  std::vector<std::string> words;          // in place of values
  std::optional<double> sample_rate_hz{};  // where the file says that it is even in time
  double start_s{};                        // of the first sample, where it is
  std::string trouble{};                   // the first cell that is no value, with its place; empty: none

  std::size_t size() const { return words.empty() ? values.size() : words.size(); }
};

struct ForeignFile {
  std::string format;                // "MAT 5", "CSV"
  std::vector<std::string> dialect;  // how it was read, in words: "semicolons", "decimal comma"
  std::vector<ForeignChannel> channels;
  std::vector<std::pair<std::string, std::string>> metadata;  // texts and single numbers beside the series
  std::vector<std::string> notes;                             // what was left out or corrected
};

enum class ForeignFormat { kCsv, kHdf5, kMat5, kMat73, kUff, kTdms, kAudio };

/// Told by the first bytes; a file of which no other format is known is a text.
/// @throws RecordError if it cannot be opened.
ForeignFormat ForeignFormatOf(const std::filesystem::path& path);

/// How messages and previews name it: "MAT 7.3".
std::string NameOf(ForeignFormat format);

/// The whole file. Values of integers and floats become doubles. Runs in this process: a hostile file is read
/// through `ReadInOwnProcess` (record_pipe.h).
/// @throws RecordError with file and offset or line: what cannot be read, or is cut off, and then what is
///   whole.
ForeignFile ReadForeignFile(const std::filesystem::path& path);

/// Each with its own file.
ForeignFile ReadMatFile(const std::filesystem::path& path);
ForeignFile ReadUffFile(const std::filesystem::path& path);
ForeignFile ReadTdmsFile(const std::filesystem::path& path);
ForeignFile ReadAudioFile(const std::filesystem::path& path);
ForeignFile ReadHdf5Channels(const std::filesystem::path& path);
ForeignFile ReadCsvChannels(const std::filesystem::path& path);

/// Gives channels of one name a number each: "a", "a #2".
void MakeNamesUnique(ForeignFile& file);

}  // namespace strainwave::daq
