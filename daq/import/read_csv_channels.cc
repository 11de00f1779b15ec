// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <future>
#include <limits>
#include <thread>

#include <fmt/format.h>

#include "daq/csv_text.h"
#include "daq/import/csv_dialect.h"
#include "daq/import/foreign_file.h"
#include "daq/import/mapped_file.h"
#include "daq/large_memory.h"
#include "daq/record_error.h"
#include "daq/record_limits.h"

namespace strainwave::daq {
namespace {

// Bytes that one thread reads in turn: some milliseconds.
constexpr std::size_t kPart_bytes = std::size_t{4} << 20;

struct Part {
  std::string_view text;
  std::size_t first_row{};
  std::size_t rows{};
  std::size_t lines{};
  std::size_t first_line{};
};

// What is wrong with the first cell of a column that is no value.
struct Trouble {
  std::size_t line = std::numeric_limits<std::size_t>::max();
  std::string what;
};

class Table {
 public:
  Table(const CsvDialect& dialect, const std::string& file, std::string_view text)
      : dialect_(dialect), file_(file), width_(dialect.kinds.size()) {
    CutIntoParts(text);
  }

  std::vector<ForeignChannel> Read() {
    std::vector<ForeignChannel> channels(width_);
    columns_.resize(width_);
    for (std::size_t c = 0; c < width_; ++c) {
      channels[c].name = dialect_.names[c];
      channels[c].unit = dialect_.units[c];
      if (dialect_.kinds[c] == CellKind::kWord) {
        channels[c].words.resize(rows_);
      } else {
        ReserveLarge(channels[c].values, rows_);
        channels[c].values.resize(rows_);
      }
    }
    channels_ = &channels;
    const std::size_t threads =
        std::min<std::size_t>(parts_.size(), std::max(1U, std::thread::hardware_concurrency()));
    std::vector<std::future<std::vector<Trouble>>> work;
    std::atomic<std::size_t> next{0};
    for (std::size_t t = 0; t < threads; ++t) {
      work.push_back(std::async(threads > 1 ? std::launch::async : std::launch::deferred, [&] {
        std::vector<Trouble> troubles(width_);
        for (std::size_t p; (p = next++) < parts_.size();) ReadPart(parts_[p], troubles);
        return troubles;
      }));
    }
    std::vector<Trouble> first(width_);
    for (auto& one : work) {
      const std::vector<Trouble> troubles = one.get();
      for (std::size_t c = 0; c < width_; ++c)
        if (troubles[c].line < first[c].line) first[c] = troubles[c];
    }
    for (std::size_t c = 0; c < width_; ++c) channels[c].trouble = first[c].what;
    for (std::size_t c = 0; c < width_; ++c)
      if (dialect_.kinds[c] == CellKind::kClock) GoOnOverMidnight(channels[c]);
    return channels;
  }

 private:
  void CutIntoParts(std::string_view text) {
    std::size_t line = static_cast<std::size_t>(dialect_.first_line);
    while (!text.empty()) {
      std::size_t end = std::min(text.size(), kPart_bytes);
      if (end < text.size()) {
        const std::size_t line_end = text.find('\n', end);
        end = line_end == text.npos ? text.size() : line_end + 1;
      }
      Part part{.text = text.substr(0, end), .first_row = rows_, .rows = 0, .lines = 0, .first_line = line};
      std::string_view rest = part.text;
      while (!rest.empty()) {
        const Line one = TakeLine(rest);
        DemandShort(one.text, file_, line + part.lines);
        ++part.lines;
        if (!IsBlank(one.text)) ++part.rows;
      }
      rows_ += part.rows;
      line += part.lines;
      if (rows_ > kMostValues / width_)
        throw RecordError(fmt::format("{}:{}", file_, line), fmt::format("more than {} values", kMostValues),
                          "a smaller file");
      text.remove_prefix(end);
      parts_.push_back(part);
    }
  }

  static bool IsBlank(std::string_view line) {
    return line.empty() || ((line.front() == ' ' || line.front() == '\t') && Trim(line).empty());
  }

  void ReadPart(const Part& part, std::vector<Trouble>& troubles) {
    std::string_view rest = part.text;
    std::size_t row = part.first_row;
    for (std::size_t l = 0; l < part.lines; ++l) {
      const std::string_view line = TakeLine(rest).text;
      if (IsBlank(line)) continue;
      if (!ReadPlainRow(line, row)) ReadAnyRow(line, row, part.first_line + l, troubles);
      ++row;
    }
  }

  // Numbers alone, with points: what long files are made of.
  bool ReadPlainRow(std::string_view line, std::size_t row) {
    if (dialect_.decimal_comma || dialect_.separator == ' ') return false;
    const char* at = line.data();
    const char* const end = at + line.size();
    for (std::size_t c = 0; c < width_; ++c) {
      if (dialect_.kinds[c] != CellKind::kNumber) return false;
      while (at < end && *at == ' ') ++at;
      double value{};
      const auto [stop, error] = std::from_chars(at, end, value);
      if (error != std::errc() || !std::isfinite(value)) return false;
      at = stop;
      while (at < end && *at == ' ') ++at;
      (*channels_)[c].values[row] = value;
      if (c + 1 == width_) break;
      if (at == end || *at != dialect_.separator) return false;
      ++at;
    }
    return at == end || (*at == dialect_.separator && at + 1 == end);
  }

  void ReadAnyRow(std::string_view line, std::size_t row, std::size_t number,
                  std::vector<Trouble>& troubles) {
    const auto cells = CellsOf(line, dialect_.separator, dialect_.ends_with_separator);
    if (cells.size() != width_)
      throw RecordError(fmt::format("{}:{}:1", file_, number),
                        fmt::format("the line has {} cells", cells.size()),
                        fmt::format("{}, as line {} has", width_, dialect_.first_line));
    for (std::size_t c = 0; c < width_; ++c) {
      ForeignChannel& channel = (*channels_)[c];
      const auto& [cell, at] = cells[c];
      if (dialect_.kinds[c] == CellKind::kWord) {
        channel.words[row] = cell;
        continue;
      }
      const std::optional<double> value = dialect_.kinds[c] == CellKind::kClock
                                              ? ClockSeconds(cell)
                                              : CsvNumber(cell, dialect_.decimal_comma);
      channel.values[row] = value.value_or(std::numeric_limits<double>::quiet_NaN());
      if (!value && number < troubles[c].line)
        troubles[c] = {number, fmt::format("{}:{}:{}: {} is no {}", file_, number, at + 1, Quoted(cell),
                                           dialect_.kinds[c] == CellKind::kClock ? "time of day" : "number")};
    }
  }

  // The time of day starts anew at midnight.
  static void GoOnOverMidnight(ForeignChannel& channel) {
    constexpr double kDay_s = 86400.0;
    double days_s = 0.0;
    double last_s = 0.0;
    for (std::size_t i = 0; i < channel.values.size(); ++i) {
      const double own_s = channel.values[i];
      if (i > 0 && own_s < last_s - kDay_s / 2.0) days_s += kDay_s;
      last_s = own_s;
      channel.values[i] = own_s + days_s;
    }
    if (channel.unit.empty() || channel.unit != "s") channel.unit = "s";
  }

  const CsvDialect& dialect_;
  const std::string& file_;
  std::size_t width_;
  std::size_t rows_{};
  std::vector<Part> parts_;
  std::vector<std::vector<double>> columns_;
  std::vector<ForeignChannel>* channels_{};
};

}  // namespace

ForeignFile ReadCsvChannels(const std::filesystem::path& path) {
  const MappedFile mapped(path);
  std::string_view text = mapped.text();
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  const std::string file = path.string();
  constexpr std::size_t kLookedAt = std::size_t{1} << 16;
  if (const auto bad = FindNonTextByte(text.substr(0, std::min(text.size(), kLookedAt)));
      bad && *bad + 4 < std::min(text.size(), kLookedAt)) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(*bad), '\n');
    throw RecordError(fmt::format("{}:{}", file, line), "is no UTF-8 text",
                      "a text of rows of numbers, or MAT, UFF 58, TDMS, WAV, FLAC, HDF5");
  }
  const CsvDialect dialect = FindCsvDialect(text, file);
  ForeignFile read;
  read.format = "CSV";
  read.dialect = WordsOf(dialect);
  read.metadata = dialect.preamble;
  read.channels = Table(dialect, file, text.substr(dialect.first_row)).Read();
  return read;
}

}  // namespace strainwave::daq
