// SPDX-License-Identifier: Apache-2.0
#include "daq/record_pipe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>
#include <type_traits>

#include "daq/large_memory.h"
#include "daq/record_limits.h"

namespace strainwave::daq {
namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

// Numbers as they stand in memory: both ends are one program.
class Sender {
 public:
  explicit Sender(int pipe) : pipe_(pipe) {}
  void Number(std::uint64_t number) { Bytes(std::as_bytes(std::span(&number, 1))); }
  void Text(const std::string& text) {
    Number(text.size());
    Bytes(std::as_bytes(std::span(text)));
  }
  void Bytes(std::span<const std::byte> bytes) {
    constexpr std::size_t kTogether = 65536;
    if (kept_.size() + bytes.size() > kTogether) Flush();
    if (bytes.size() > kTogether) {
      WriteToPipe(pipe_, bytes);
    } else {
      kept_.insert(kept_.end(), bytes.begin(), bytes.end());
    }
  }
  void Flush() {
    WriteToPipe(pipe_, kept_);
    kept_.clear();
  }

 private:
  int pipe_;
  std::vector<std::byte> kept_;
};

// The bytes ended, or are none that a sender makes: the process is not what it was.
class BrokenOff : public std::runtime_error {
 public:
  BrokenOff() : std::runtime_error("broken off") {}
};

class Receiver {
 public:
  explicit Receiver(LimitedProcess& process) : process_(process) {}

  std::uint64_t Number() {
    std::uint64_t number{};
    Bytes(std::as_writable_bytes(std::span(&number, 1)));
    return number;
  }
  // A number of things that each take some bytes.
  std::size_t Count(std::size_t most) {
    const std::uint64_t count = Number();
    if (count > most) throw BrokenOff();
    return static_cast<std::size_t>(count);
  }
  std::string Text() {
    std::string text(Count(kMostText), '\0');
    Bytes(std::as_writable_bytes(std::span(text)));
    return text;
  }
  template <typename Value>
  std::vector<Value> Values() {
    const std::size_t count = Count(values_left_);
    values_left_ -= count;
    std::vector<Value> values;
    ReserveLarge(values, count);
    values.resize(count);
    Bytes(std::as_writable_bytes(std::span(values)));
    return values;
  }

 private:
  static constexpr std::size_t kMostText = std::size_t{64} << 20;

  void Bytes(std::span<std::byte> bytes) {
    while (!bytes.empty()) {
      const std::size_t got = process_.Read(bytes);
      if (got == 0) throw BrokenOff();
      bytes = bytes.subspan(got);
    }
  }

  LimitedProcess& process_;
  std::size_t values_left_{kMostValues};
};

void Send(Sender& out, const Pairs& pairs) {
  out.Number(pairs.size());
  for (const auto& [key, value] : pairs) {
    out.Text(key);
    out.Text(value);
  }
}

Pairs ReceivePairs(Receiver& in) {
  Pairs pairs(in.Count(kMostMetadata));
  for (auto& [key, value] : pairs) {
    key = in.Text();
    value = in.Text();
  }
  return pairs;
}

void Send(Sender& out, std::span<const RecordNote> notes) {
  out.Number(notes.size());
  for (const RecordNote& note : notes) {
    out.Number(static_cast<std::size_t>(note.line));
    out.Text(note.text);
  }
}

std::vector<RecordNote> ReceiveNotes(Receiver& in) {
  std::vector<RecordNote> notes(in.Count(2 * kMostMetadata));
  for (RecordNote& note : notes) {
    note.line = static_cast<int>(in.Number());
    note.text = in.Text();
  }
  return notes;
}

void Send(Sender& out, const Column& column) {
  out.Text(column.name);
  out.Text(column.sensor_serial);
  out.Text(column.calibration);
  Send(out, column.calibration_terms);
  out.Number(column.values.index());
  std::visit(
      [&out](const auto& values) {
        out.Number(values.size());
        out.Bytes(std::as_bytes(std::span(values)));
      },
      column.values);
}

Column ReceiveColumn(Receiver& in) {
  Column column;
  column.name = in.Text();
  column.sensor_serial = in.Text();
  column.calibration = in.Text();
  column.calibration_terms = ReceivePairs(in);
  switch (in.Number()) {
    case 0:
      column.values = in.Values<double>();
      break;
    case 1:
      column.values = in.Values<float>();
      break;
    case 2:
      column.values = in.Values<Direction>();
      break;
    default:
      throw BrokenOff();
  }
  return column;
}

void Send(Sender& out, const Record& record) {
  out.Text(std::string(record.kind.name()));
  Send(out, record.metadata);
  Send(out, record.notes);
  out.Text(record.source.file);
  out.Text(record.source.group);
  out.Text(record.source.specimen);
  out.Number(record.columns.size());
  for (const Column& column : record.columns) Send(out, column);
}

Record ReceiveRecord(Receiver& in) {
  Record record;
  record.kind = RecordKind::Named(in.Text());
  record.metadata = ReceivePairs(in);
  record.notes = ReceiveNotes(in);
  record.source.file = in.Text();
  record.source.group = in.Text();
  record.source.specimen = in.Text();
  record.columns.resize(in.Count(kMostColumns));
  for (Column& column : record.columns) column = ReceiveColumn(in);
  return record;
}

// The findings of a RecordError, none where the records follow.
constexpr std::size_t kMostFindings = 100'000;

void Send(Sender& out, std::span<const Finding> findings) {
  findings = findings.first(std::min(findings.size(), kMostFindings));
  out.Number(findings.size());
  for (const Finding& finding : findings) {
    out.Text(finding.place);
    out.Text(finding.what);
    out.Text(finding.expected);
  }
}

std::vector<Finding> ReceiveFindings(Receiver& in) {
  std::vector<Finding> findings(in.Count(kMostFindings));
  for (Finding& finding : findings) {
    finding.place = in.Text();
    finding.what = in.Text();
    finding.expected = in.Text();
  }
  return findings;
}

void Send(Sender& out, const std::vector<Record>& records) {
  out.Number(records.size());
  for (const Record& record : records) Send(out, record);
}

void Receive(Receiver& in, std::vector<Record>& records) {
  records.resize(in.Count(kMostGroups));
  for (Record& record : records) record = ReceiveRecord(in);
}

void Send(Sender& out, const ArraysFile& file) {
  Send(out, file.attributes);
  out.Number(file.arrays.size());
  for (const NamedArray& array : file.arrays) {
    out.Text(array.name);
    out.Number(array.shape.size());
    for (const std::size_t extent : array.shape) out.Number(extent);
    out.Number(array.values.size());
    out.Bytes(std::as_bytes(std::span(array.values)));
  }
}

void Receive(Receiver& in, ArraysFile& file) {
  constexpr std::size_t kMostDimensions = 32;  // of HDF5
  file.attributes = ReceivePairs(in);
  file.arrays.resize(in.Count(kMostGroups));
  for (NamedArray& array : file.arrays) {
    array.name = in.Text();
    array.shape.resize(in.Count(kMostDimensions));
    for (std::size_t& extent : array.shape) extent = in.Number();
    array.values = in.Values<double>();
  }
}

template <typename What>
void SendWhatIsRead(int pipe, const std::function<What()>& read) {
  Sender out(pipe);
  try {
    const What what = read();
    Send(out, std::span<const Finding>{});
    Send(out, what);
  } catch (const RecordError& error) {
    Send(out, std::span(error.findings()));
  }
  out.Flush();
}

}  // namespace

ProcessLimits LimitsForFile(const std::filesystem::path& path) {
  // Checksums and inflating run at 100 MB/s and more, and what is read is copied twice at most.
  constexpr std::uintmax_t kBytesPerSecond = 4'000'000;
  constexpr std::chrono::seconds kLeastTime(10);
  constexpr std::chrono::seconds kLongestSilence(120);
  constexpr std::size_t kLeast_bytes = std::size_t{1} << 30;
  constexpr std::size_t kMost_bytes = std::size_t{8} << 30;  // kMostValues as doubles, and as they are read
  std::error_code ignored;
  const std::uintmax_t size = std::filesystem::file_size(path, ignored);
  const auto seconds = std::chrono::seconds(static_cast<std::int64_t>(ignored ? 0 : size / kBytesPerSecond));
  const std::uintmax_t extra_bytes = ignored ? 0 : std::min<std::uintmax_t>(size, kMost_bytes) * 16;
  return {.memory_bytes = std::min(kMost_bytes, kLeast_bytes + static_cast<std::size_t>(extra_bytes)),
          .processor = kLeastTime + seconds,
          .silence = kLongestSilence + seconds};
}

namespace {

template <typename What>
What ReadApart(const std::filesystem::path& path, const ProcessLimits& limits,
               const std::function<What()>& read, std::string_view reader) {
  LimitedProcess process(limits, [&read](int pipe) { SendWhatIsRead(pipe, read); });
  std::vector<Finding> findings;
  What what;
  std::string trouble;
  try {
    Receiver in(process);
    findings = ReceiveFindings(in);
    if (findings.empty()) Receive(in, what);
    trouble = process.End();
  } catch (const BrokenOff&) {
    trouble = process.End();
    if (trouble.empty()) trouble = "stopped in the middle";
  }
  if (!trouble.empty()) {
    throw RecordError(path.string(), fmt::format("{} cannot read the file: it {}", reader, trouble),
                      "the file as it was written");
  }
  if (!findings.empty()) throw RecordError(std::move(findings));
  return what;
}

}  // namespace

std::vector<Record> ReadInOwnProcess(const std::filesystem::path& path, const ProcessLimits& limits,
                                     const std::function<std::vector<Record>()>& read,
                                     std::string_view reader) {
  return ReadApart(path, limits, read, reader);
}

ArraysFile ReadArraysInOwnProcess(const std::filesystem::path& path, const ProcessLimits& limits,
                                  const std::function<ArraysFile()>& read) {
  return ReadApart(path, limits, read, "the HDF5 library");
}

}  // namespace strainwave::daq
