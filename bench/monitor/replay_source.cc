// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/replay_source.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "analysis/units.h"
#include "bench/campaign/folder.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/record_features.h"
#include "bench/prediction/record_operating_point.h"
#include "bench/records/record_data.h"
#include "daq/record_error.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kBlock = 8192;
constexpr double kNanoseconds = 1e9;

std::int64_t DurationOf_ns(const VibrationChunk& chunk, std::size_t samples) {
  return std::llround(static_cast<double>(samples) * kNanoseconds / chunk.sample_rate_hz);
}

// The columns that are signals.
std::vector<std::string> SignalsOf(const daq::Record& record) {
  if (record.kind == daq::RecordKind::kVibration) return VibrationChannelsOf(record);
  std::vector<std::string> names;
  for (const daq::Column& column : record.columns) {
    if (column.name != "time_s") names.push_back(column.name);
  }
  return names;
}

// Turns of the output shaft from its start, where the record tells the speed of the input.
std::vector<double> OutputTurnsOf(const daq::Record& record, double ratio, double sample_rate_hz) {
  std::vector<double> values = InputSpeedsOf_rad_per_s(record);
  if (values.size() == 1) values.resize(record.rows(), values.front());
  double turns = 0.0;
  for (double& value : values) {
    const double step = value / (kTwoPi * ratio * sample_rate_hz);
    value = turns;
    turns += step;
  }
  return values;
}

// What a record tells of torque, speed and temperature, as a device would: a channel each. A number of its
// metadata holds throughout.
void AddOperatingChannels(const daq::Record& record, VibrationChunk& whole) {
  for (const OperatingName& name : OperatingNames()) {
    if (std::ranges::find(whole.channels, name.name) != whole.channels.end()) continue;
    std::vector<double> values = OperatingValuesOf(record, name.name);
    if (values.size() == 1) values.resize(record.rows(), values.front());
    if (values.empty()) continue;
    whole.channels.emplace_back(name.name);
    whole.samples.push_back(std::move(values));
  }
}

}  // namespace

ReplaySource::ReplaySource(ReplaySettings settings)
    : settings_(std::move(settings)),
      began_(std::chrono::steady_clock::now()),
      next_start_ns_(settings_.start_ns),
      last_ns_(settings_.start_ns) {}

std::int64_t ReplaySource::NowNanoseconds() const {
  if (!std::isfinite(settings_.pace)) return last_ns_;
  const std::chrono::duration<double, std::nano> passed = std::chrono::steady_clock::now() - began_;
  return settings_.start_ns + std::llround(passed.count() * settings_.pace);
}

bool ReplaySource::DueWithin(std::int64_t time_ns, std::chrono::milliseconds patience) const {
  if (!std::isfinite(settings_.pace)) return true;
  const std::chrono::duration<double, std::nano> wait(static_cast<double>(time_ns - NowNanoseconds()) /
                                                      settings_.pace);
  std::this_thread::sleep_for(std::min<std::chrono::duration<double, std::nano>>(wait, patience));
  return wait <= patience;
}

ReplaySource::Got ReplaySource::Next(std::chrono::milliseconds patience, VibrationChunk& chunk) {
  if (!playing_ && !LoadNext()) return Got::kEnd;
  const std::size_t samples = playing_->whole.samples.empty() ? 0 : playing_->whole.samples.front().size();
  const std::size_t to = std::min(playing_->at + kBlock, samples);
  const std::int64_t end_ns =
      playing_->whole.time_ns + (to > 0 ? DurationOf_ns(playing_->whole, to) : std::int64_t{0});
  if (!DueWithin(end_ns, patience)) return Got::kNothingYet;
  TakeBlock(chunk);
  last_ns_ = end_ns;
  return Got::kChunk;
}

void ReplaySource::TakeBlock(VibrationChunk& chunk) {
  VibrationChunk& whole = playing_->whole;
  if (whole.samples.empty()) {
    chunk = std::move(whole);
    playing_.reset();
    return;
  }
  const std::size_t from = playing_->at;
  const std::size_t to = std::min(from + kBlock, whole.samples.front().size());
  const auto part = [from, to](const std::vector<double>& values) {
    if (values.empty()) return std::vector<double>{};
    return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(from),
                               values.begin() + static_cast<std::ptrdiff_t>(to));
  };
  chunk = {.time_ns = whole.time_ns + DurationOf_ns(whole, from),
           .sample_rate_hz = whole.sample_rate_hz,
           .channels = whole.channels,
           .samples = {},
           .output_turns = part(whole.output_turns),
           .begins_measurement = from == 0,
           .ends_measurement = to == whole.samples.front().size(),
           .origin = whole.origin,
           .trouble = {}};
  for (const auto& samples : whole.samples) chunk.samples.push_back(part(samples));
  playing_->at = to;
  if (chunk.ends_measurement) playing_.reset();
}

bool ReplaySource::LoadNext() {
  while (loaded_.empty()) {
    if (next_file_ == settings_.files.size()) {
      next_file_ = 0;
      ++round_;
    }
    if (round_ >= settings_.rounds || settings_.files.empty()) return false;
    LoadFile(settings_.files[next_file_++]);
  }
  VibrationChunk whole = std::move(loaded_.back());
  loaded_.pop_back();
  whole.time_ns = next_start_ns_;
  const std::int64_t length_ns =
      whole.samples.empty() ? 0 : DurationOf_ns(whole, whole.samples.front().size());
  next_start_ns_ += std::max<std::int64_t>(length_ns, std::llround(settings_.every_s * kNanoseconds));
  playing_ = Playing{std::move(whole), 0};
  return true;
}

void ReplaySource::LoadFile(const std::filesystem::path& path) {
  VibrationChunk trouble;
  trouble.origin = path.string();
  try {
    for (const daq::Record& record : settings_.read(path)) AddRecord(record);
  } catch (const daq::RecordError& error) {
    trouble.trouble = error.what();
  } catch (const BenchError& error) {
    trouble.trouble = error.what();
  }
  if (!trouble.trouble.empty()) loaded_.push_back(std::move(trouble));
  std::ranges::reverse(loaded_);
}

void ReplaySource::AddRecord(const daq::Record& record) {
  const double rate_hz = SampleRateOf_hz(record);
  VibrationChunk whole{
      .time_ns = 0,
      .sample_rate_hz = rate_hz,
      .channels = SignalsOf(record),
      .samples = {},
      .output_turns = OutputTurnsOf(record, settings_.ratio, rate_hz),
      .origin = record.source.file + (record.source.group.empty() ? "" : " ") + record.source.group,
      .trouble = {}};
  for (const std::string& channel : whole.channels) whole.samples.push_back(record.CopyAsDoubles(channel));
  AddOperatingChannels(record, whole);
  if (whole.samples.empty() || whole.samples.front().empty()) {
    whole.samples.clear();
    whole.trouble = "the record has no samples (expected signals)";
  }
  loaded_.push_back(std::move(whole));
}

std::vector<std::filesystem::path> RecordFilesOf(const std::vector<std::filesystem::path>& paths) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    const std::filesystem::path cycles = CampaignFolder{path}.Cycles();
    std::vector<std::filesystem::path> of_campaign;
    if (std::filesystem::is_directory(cycles)) {
      for (const auto& entry : std::filesystem::directory_iterator(cycles))
        of_campaign.push_back(entry.path());
    }
    std::erase_if(of_campaign, [](const auto& file) { return file.extension() != ".h5"; });
    if (of_campaign.empty()) Refuse(path, "holds no cycles", "a campaign, or record files");
    std::ranges::sort(of_campaign);
    files.insert(files.end(), of_campaign.begin(), of_campaign.end());
  }
  return files;
}

}  // namespace strainwave::bench
