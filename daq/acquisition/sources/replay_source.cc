// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/sources/replay_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <thread>

#include "daq/acquisition/sources/steady_now.h"
#include "daq/read_records.h"
#include "daq/record_error.h"
#include "daq/record_pipe.h"
#include "daq/value_bounds.h"

namespace strainwave::daq::acquisition {
namespace {

using std::chrono::nanoseconds;

// What a double counts exactly, and what 64 bits hold of nanoseconds.
constexpr double kMostSamples = 9e15;
constexpr double kLongest_s = 9e9;

nanoseconds TimeOf(double samples, double rate_hz) {
  return nanoseconds(std::llround(samples * 1e9 / rate_hz));
}

// A stream stays open while it is replayed: another process reads it to its end before this one opens it.
// False for a file that is none; RecordError as that of `StreamFileReader`.
bool IsReadableStream(const std::filesystem::path& path) {
  const std::vector<Record> found = ReadInOwnProcess(path, LimitsForFile(path), [&path] {
    std::vector<Record> streams;
    if (!IsStreamFile(path)) return streams;
    const StreamFileReader stream(path);
    for (const BlockRow& block : stream.blocks()) stream.Words(block.row, block.samples);
    streams.emplace_back().kind = RecordKind::kHistory;
    return streams;
  });
  return !found.empty();
}

double RateOf(const Record& record, const std::string& path) {
  if (const std::optional<std::string> text = record.Metadata("sample_rate_hz")) {
    const std::optional<double> rate_hz = NumberFromText(*text);
    if (rate_hz && *rate_hz > 0 && std::isfinite(*rate_hz)) return *rate_hz;
  }
  if (record.FindColumn("time_s") != nullptr && record.rows() >= 2) {
    const std::span<const double> time_s = record.Doubles("time_s");
    std::vector<double> steps;
    for (std::size_t i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                     steps.end());
    if (steps[steps.size() / 2] > 0) return 1 / steps[steps.size() / 2];
  }
  throw RecordError(path, "the record has no rate to replay it at",
                    "sample_rate_hz, or a time_s that goes on");
}

}  // namespace

void ReplaySource::Start() {
  description_ = {};
  next_block_ = next_row_ = 0;
  if (IsReadableStream(settings_.path)) {
    stream_ = std::make_unique<StreamFileReader>(settings_.path);
    description_ = stream_->description();
  } else {
    StartRecord();
  }
  began_ = SteadyNow();
}

void ReplaySource::StartRecord() {
  const std::vector<Record> records = ReadRecords(settings_.path);
  const Record& record = records.front();
  description_.name = settings_.path.string();
  description_.type = SampleType::kFloat32;
  description_.rate_hz = RateOf(record, description_.name);
  description_.most_samples_a_block = settings_.samples_a_block;
  columns_.clear();
  for (const Column& column : record.columns) {
    if (column.name == "time_s" || std::holds_alternative<std::vector<Direction>>(column.values)) continue;
    description_.channels.push_back({.name = column.name,
                                     .unit = std::string(UnitOf(column.name)),
                                     .sensor_serial = column.sensor_serial});
    columns_.push_back(record.CopyAsDoubles(column.name));
  }
  counters_.assign(record.rows(), 0);
  const bool has_time = record.FindColumn("time_s") != nullptr;
  const auto too_far = [this](std::size_t row) {
    return RecordError(
        description_.name,
        fmt::format("row {} lies too far from the first at {} Hz", row + 1, description_.rate_hz),
        "a record of less than 9e15 samples and 9e9 s");
  };
  for (std::size_t i = 0; i < counters_.size(); ++i) {
    counters_[i] = i;
    if (has_time) {
      const std::span<const double> time_s = record.Doubles("time_s");
      const double place = std::round((time_s[i] - time_s[0]) * description_.rate_hz);
      if (!(place < kMostSamples)) throw too_far(i);
      // Jitter that puts two rows on one place moves the second on.
      counters_[i] =
          std::max(i == 0 ? 0 : counters_[i - 1] + 1, static_cast<std::uint64_t>(std::max(0.0, place)));
    }
    if (!(static_cast<double>(counters_[i] + 1) / description_.rate_hz < kLongest_s)) throw too_far(i);
  }
}

void ReplaySource::Stop() noexcept {
  stream_.reset();
  columns_.clear();
  counters_.clear();
}

// When the next block would have been here, since the first began.
nanoseconds ReplaySource::DueTime() const {
  if (stream_) {
    const BlockRow& block = stream_->blocks()[next_block_];
    return nanoseconds(block.arrival_ns - stream_->blocks().front().arrival_ns);
  }
  const std::size_t last = std::min(next_row_ + settings_.samples_a_block, counters_.size()) - 1;
  return TimeOf(static_cast<double>(counters_[last] + 1), description_.rate_hz);
}

NextResult ReplaySource::Next(SampleBlock& block, nanoseconds patience) {
  const bool is_over = stream_ ? next_block_ >= stream_->blocks().size() : next_row_ >= counters_.size();
  if (is_over) return NextResult::kEnded;
  if (settings_.speed > 0) {
    const nanoseconds due =
        began_ + nanoseconds(std::llround(static_cast<double>(DueTime().count()) / settings_.speed));
    const nanoseconds wait = due - SteadyNow();
    if (wait > patience) {
      std::this_thread::sleep_for(patience);
      return NextResult::kNothingYet;
    }
    if (wait.count() > 0) std::this_thread::sleep_for(wait);
  }
  const NextResult result = stream_ ? NextOfStream(block) : NextOfRecord(block);
  if (settings_.speed > 0) block.header.arrival = SteadyNow();
  return result;
}

NextResult ReplaySource::NextOfStream(SampleBlock& block) {
  const BlockRow& row = stream_->blocks()[next_block_++];
  block.header = {.source = description_.source,
                  .channels = static_cast<std::uint32_t>(description_.channels.size()),
                  .samples = row.samples,
                  .type = description_.type,
                  .flags = row.flags,
                  .device_counter = row.device_counter,
                  .first_sample = row.first_sample,
                  .lost_before = row.lost_before,
                  .device_time = nanoseconds(row.device_time_ns),
                  .arrival = nanoseconds(row.arrival_ns),
                  .rate_hz = description_.rate_hz};
  const std::vector<std::uint32_t> words = stream_->Words(row.row, row.samples);
  std::copy(words.begin(), words.end(), block.words().begin());
  return NextResult::kBlock;
}

NextResult ReplaySource::NextOfRecord(SampleBlock& block) {
  std::uint32_t samples = 0;
  const std::size_t begin = next_row_;
  while (next_row_ < counters_.size() && samples < settings_.samples_a_block &&
         counters_[next_row_] == counters_[begin] + samples) {
    ++samples;
    ++next_row_;
  }
  block.header = {.source = description_.source,
                  .channels = static_cast<std::uint32_t>(columns_.size()),
                  .samples = samples,
                  .type = SampleType::kFloat32,
                  .device_counter = counters_[begin],
                  .first_sample = counters_[begin],
                  .device_time = TimeOf(static_cast<double>(counters_[begin]), description_.rate_hz),
                  .arrival = TimeOf(static_cast<double>(counters_[begin] + samples), description_.rate_hz),
                  .rate_hz = description_.rate_hz};
  const std::span<std::uint32_t> words = block.words();
  std::size_t at = 0;
  for (std::size_t row = begin; row < next_row_; ++row) {
    for (const std::vector<double>& column : columns_) {
      words[at++] = std::bit_cast<std::uint32_t>(static_cast<float>(column[row]));
    }
  }
  return NextResult::kBlock;
}

}  // namespace strainwave::daq::acquisition
