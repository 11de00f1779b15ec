// SPDX-License-Identifier: Apache-2.0
#include "bench/health/motor_records.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/health/motor_cycles.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/record_features.h"
#include "bench/records/record_refusal.h"

namespace strainwave::bench {
namespace {

namespace health = analysis::health;

constexpr double kSameRate = 0.01;

// By time_s, by sample_rate_hz, or assumed; where both are there they agree.
double RateOf(const daq::Record& record, std::vector<RecordWarning>& warnings) {
  const auto stated = record.Metadata("sample_rate_hz");
  if (record.FindColumn("time_s") == nullptr) {
    if (stated) return SampleRateOf_hz(record);
    warnings.push_back({record.source.file, 0,
                        fmt::format("neither time_s nor sample_rate_hz is there; {:g} Hz is assumed",
                                    kAssumedMotorRate_hz)});
    return kAssumedMotorRate_hz;
  }
  daq::Record by_time = record;
  std::erase_if(by_time.metadata, [](const auto& entry) { return entry.first == "sample_rate_hz"; });
  const double rate_hz = SampleRateOf_hz(by_time);
  if (stated && std::abs(SampleRateOf_hz(record) - rate_hz) > kSameRate * rate_hz)
    throw RecordRefusal(
        record, fmt::format("sample_rate_hz is {:g} and time_s goes on at {:g} Hz (expected one rate)",
                            SampleRateOf_hz(record), rate_hz));
  return rate_hz;
}

std::vector<double> StateOf(const daq::Record& record) {
  if (record.FindColumn("state") == nullptr) return {};
  return record.CopyAsDoubles("state");
}

struct CutRecord {
  std::vector<std::vector<double>> channels;  // as kMotorChannels
  health::MotorCycles cut;
};

CutRecord CutIntoCycles(const daq::Record& record) {
  CutRecord result;
  for (const std::string& channel : kMotorChannels) result.channels.push_back(record.CopyAsDoubles(channel));
  result.cut = health::CutCycles(StateOf(record), result.channels.back());
  for (const health::CycleRows& cycle : result.cut.cycles) {
    if (cycle.count < kFewestCycleRows)
      throw RecordRefusal(
          record, fmt::format("a cycle has {} rows (expected {} or more)", cycle.count, kFewestCycleRows));
  }
  return result;
}

std::vector<daq::Record> ReadMotorRecords(const RecordReader& reader, const std::filesystem::path& path) {
  std::vector<daq::Record> records = reader.Read(path);
  std::set<std::string> kinds;
  for (const daq::Record& record : records) kinds.emplace(record.kind.name());
  std::erase_if(records, [](const daq::Record& record) { return record.kind != daq::RecordKind::kMotor; });
  if (records.empty()) Refuse(path, fmt::format("kind is {}", fmt::join(kinds, ", ")), "motor");
  return records;
}

MotorFeatures FeaturesOf(const daq::Record& record, analysis::features::PacketFeatures& features,
                         std::optional<double> sample_rate_hz) {
  MotorFeatures result;
  result.file = record.source.file;
  result.shortest = std::numeric_limits<std::size_t>::max();
  for (const daq::RecordNote& note : record.notes)
    result.warnings.push_back({record.source.file, note.line, note.text});
  result.sample_rate_hz = RateOf(record, result.warnings);
  if (sample_rate_hz && std::abs(result.sample_rate_hz - *sample_rate_hz) > kSameRate * *sample_rate_hz)
    throw RecordRefusal(record, fmt::format("the sampling rate is {:g} Hz (expected {:g} Hz, as in training)",
                                            result.sample_rate_hz, *sample_rate_hz));
  const auto [channels, cut] = CutIntoCycles(record);
  result.cut = cut.note;
  const std::size_t per_channel = features.CountPerChannel();
  result.values.resize(static_cast<Eigen::Index>(cut.cycles.size()),
                       static_cast<Eigen::Index>(per_channel * channels.size()));
  std::vector<double> row(per_channel * channels.size());
  for (std::size_t k = 0; k < cut.cycles.size(); ++k) {
    const health::CycleRows& cycle = cut.cycles[k];
    result.shortest = std::min(result.shortest, cycle.count);
    result.longest = std::max(result.longest, cycle.count);
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const auto samples = std::span<const double>(channels[c]).subspan(cycle.begin, cycle.count);
      if (k == 0) result.first_cycle.emplace_back(samples.begin(), samples.end());
      const auto [low, high] = std::ranges::minmax(samples);
      if (!(high > low))
        throw RecordRefusal(record,
                            fmt::format("{} is {:g} throughout (expected a signal: is the sensor connected?)",
                                        kMotorChannels[c], low));
      try {
        result.floored += features.Compute(samples, std::span(row).subspan(c * per_channel, per_channel));
      } catch (const std::invalid_argument& error) {
        throw RecordRefusal(record, fmt::format("{}: {}", kMotorChannels[c], error.what()));
      }
    }
    result.values.row(static_cast<Eigen::Index>(k)) =
        Eigen::Map<const Eigen::RowVectorXd>(row.data(), static_cast<Eigen::Index>(row.size()));
  }
  return result;
}

}  // namespace

std::vector<MotorFeatures> FeaturesOfMotorFile(const RecordReader& reader, const std::filesystem::path& path,
                                               analysis::features::PacketFeatures& features,
                                               std::optional<double> sample_rate_hz) {
  std::vector<MotorFeatures> all;
  for (const daq::Record& record : ReadMotorRecords(reader, path))
    all.push_back(FeaturesOf(record, features, sample_rate_hz));
  return all;
}

std::vector<daq::Record> ReadMotorCycles(const RecordReader& reader, const std::filesystem::path& path) {
  std::vector<daq::Record> cycles;
  for (const daq::Record& record : ReadMotorRecords(reader, path)) {
    std::vector<RecordWarning> warnings;
    const double rate_hz = RateOf(record, warnings);
    const auto [channels, cut] = CutIntoCycles(record);
    for (const health::CycleRows& rows : cut.cycles) {
      daq::Record cycle{.kind = record.kind, .metadata = {}, .columns = {}, .source = record.source};
      cycle.SetMetadata("sample_rate_hz", rate_hz);
      for (std::size_t c = 0; c < channels.size(); ++c) {
        const auto samples = std::span<const double>(channels[c]).subspan(rows.begin, rows.count);
        cycle.columns.push_back(
            {kMotorChannels[c], std::vector<double>(samples.begin(), samples.end()), {}, {}});
      }
      cycles.push_back(std::move(cycle));
    }
  }
  return cycles;
}

}  // namespace strainwave::bench
