// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <mutex>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/quantities.h"
#include "analysis/units.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/record_features.h"
#include "bench/prediction/record_labels.h"
#include "bench/prediction/record_operating_point.h"
#include "bench/prediction/source_rows.h"
#include "bench/records/record_data.h"
#include "bench/records/record_refusal.h"
#include "bench/records/vibration_channels.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kManyRecords = 200;
constexpr std::size_t kWantedWindows = 400;
constexpr double kLeastSamples = 2048.0;
constexpr double kLeastTurns = 8.0;

// One record, without its samples.
struct Facts {
  daq::Record record;  // no columns
  VibrationColumns columns;
  std::vector<std::string> labels;  // of the predicted quantities
  bool has_class{};
  double sample_rate_hz{};
  std::size_t rows{};
  std::optional<double> speed_rad_per_s;
};

std::vector<daq::Record> ReadFile(const std::filesystem::path& file, const SourceSettings& settings) {
  return ReadVibrationRecords(file, MotorTorqueAdded(settings.motor_torque), settings.reader);
}

Facts FactsOf(daq::Record record) {
  Facts facts{.record = {},
              .columns = SortVibrationColumns(record),
              .labels = {},
              .has_class = ClassOf(record).has_value(),
              .sample_rate_hz = SampleRateOf_hz(record),
              .rows = record.rows(),
              .speed_rad_per_s = SteadyInputSpeedOf_rad_per_s(record)};
  for (const analysis::Quantity& quantity : analysis::kPredictedQuantities) {
    if (LabelOf(record, std::string(quantity.name))) facts.labels.emplace_back(quantity.name);
  }
  record.columns.clear();
  facts.record = std::move(record);
  return facts;
}

// The task is given each file's number; HDF5 is read by one thread at a time, and so is everything else here.
template <typename Task>
void OverFiles(const std::vector<std::filesystem::path>& files, const SourceSettings& settings,
               const Task& task) {
  std::mutex reading;
  OnAllProcessors(files.size(), [&](std::size_t i) {
    std::vector<daq::Record> records;
    if (files[i].extension() == ".csv") {
      records = ReadFile(files[i], settings);
    } else {
      const std::lock_guard lock(reading);
      records = ReadFile(files[i], settings);
    }
    task(i, std::move(records));
  });
}

std::vector<Facts> AllFacts(const std::vector<std::filesystem::path>& files, const SourceSettings& settings) {
  std::vector<std::vector<Facts>> of_file(files.size());
  OverFiles(files, settings, [&](std::size_t i, std::vector<daq::Record> records) {
    for (daq::Record& record : records) of_file[i].push_back(FactsOf(std::move(record)));
  });
  std::vector<Facts> all;
  for (auto& facts : of_file) std::ranges::move(facts, std::back_inserter(all));
  return all;
}

std::vector<std::string> OutputsOf(const std::vector<Facts>& all) {
  std::vector<std::string> outputs;
  for (const analysis::Quantity& quantity : analysis::kPredictedQuantities) {
    const std::string name(quantity.name);
    if (std::ranges::any_of(
            all, [&](const Facts& one) { return std::ranges::find(one.labels, name) != one.labels.end(); })) {
      outputs.push_back(name);
    }
  }
  if (outputs.empty() && std::ranges::any_of(all, &Facts::has_class)) outputs = {kClassLabel};
  return outputs;
}

void RequireAlike(const std::vector<Facts>& all, const SourceSettings& settings,
                  const SignalSettings& signals) {
  for (const Facts& one : all) {
    if (DecimationFactor(one.sample_rate_hz, signals) == 0) {
      throw RecordRefusal(
          one.record,
          signals.decimates
              ? fmt::format("the sampling rate is {:g} Hz (expected a whole multiple of {:g} Hz)",
                            one.sample_rate_hz, signals.sample_rate_hz)
              : fmt::format(
                    "the sampling rate is {:g} Hz (expected {:g} Hz, as in {}; --rate HZ brings whole "
                    "multiples down to one rate)",
                    one.sample_rate_hz, signals.sample_rate_hz, all.front().record.source.file));
    }
    for (const std::string& channel : signals.channels) {
      if (std::ranges::find(one.columns.channels, channel) != one.columns.channels.end()) continue;
      const auto warned =
          std::ranges::find(one.columns.warnings, channel, &std::pair<std::string, std::string>::first);
      if (warned != one.columns.warnings.end()) throw RecordRefusal(one.record, warned->second);
      throw RecordRefusal(one.record,
                          fmt::format("there is no channel {} (expected {}; --channels names those to take)",
                                      channel, fmt::join(signals.channels, ", ")));
    }
    for (const std::string& channel : one.columns.channels) {
      if (!settings.channels.empty() ||
          std::ranges::find(signals.channels, channel) != signals.channels.end()) {
        continue;
      }
      throw RecordRefusal(
          one.record,
          fmt::format("there is a channel {} (expected {}, as in {}; --channels names those to take)",
                      channel, fmt::join(signals.channels, ", "), all.front().record.source.file));
    }
  }
}

std::vector<std::string> ChannelsOf(const Facts& one) {
  if (!one.columns.channels.empty()) return one.columns.channels;
  throw RecordRefusal(
      one.record,
      fmt::format("no column is a channel of vibration{} (expected one such as accel_x_m_per_s2)",
                  one.columns.warnings.empty() ? "" : ": " + one.columns.warnings.front().second));
}

// What holds for several records in the same words is told once, with the first of them.
std::vector<RecordWarning> WarningsOfAll(const std::vector<Facts>& all) {
  std::vector<RecordWarning> warnings;
  std::vector<std::size_t> records;
  for (const Facts& one : all) {
    for (RecordWarning& warning : bench::WarningsOf(one.record)) {
      const auto same = std::ranges::find(warnings, warning.text, &RecordWarning::text);
      if (same == warnings.end()) {
        warnings.push_back(std::move(warning));
        records.push_back(1);
      } else {
        ++records[static_cast<std::size_t>(same - warnings.begin())];
      }
    }
  }
  for (std::size_t i = 0; i < warnings.size(); ++i) {
    if (all.size() > 1) warnings[i].text += fmt::format("; so in {} of {} records", records[i], all.size());
  }
  return warnings;
}

WindowLength WindowFor(const std::vector<Facts>& all, const SourceSettings& settings,
                       const SignalSettings& signals) {
  if (settings.window_s == 0.0 || (!settings.window_s && all.size() >= kManyRecords)) return {};
  double samples = 0.0;
  double slowest_rad_per_s = std::numeric_limits<double>::infinity();
  bool turning = true;
  for (const Facts& one : all) {
    samples += static_cast<double>(one.rows) * signals.sample_rate_hz / one.sample_rate_hz;
    turning = turning && one.speed_rad_per_s.has_value();
    if (turning) slowest_rad_per_s = std::min(slowest_rad_per_s, *one.speed_rad_per_s);
  }
  const double samples_per_turn = turning ? signals.sample_rate_hz * kTwoPi / slowest_rad_per_s : 0.0;
  const double wanted =
      settings.window_s ? *settings.window_s * signals.sample_rate_hz
                        : std::max({samples / kWantedWindows, kLeastSamples, kLeastTurns * samples_per_turn});
  if (!turning) return {.samples = static_cast<std::size_t>(std::ceil(wanted)), .turns = 0};
  return {.samples = 0, .turns = std::max(1, static_cast<int>(std::ceil(wanted / samples_per_turn - 1e-9)))};
}

// The rows of one record; what is wrong with it is noted.
class RowTaker {
 public:
  RowTaker(const RecordFiles& records, const SourceSettings& settings)
      : records_(records),
        by_class_(records.outputs == std::vector<std::string>{kClassLabel}),
        features_(settings.features) {}

  void Take(const daq::Record& record, SourceRows& rows) {
    const std::string missing = MissingLabel(record);
    if (!missing.empty()) {
      rows.notes.push_back(RecordRefusal(record, "left out: there is no " + missing).what());
      return;
    }
    try {
      TakeWindows(record, rows);
    } catch (const BenchError& error) {
      rows.notes.emplace_back(std::string(error.what()) + "; left out");
    }
  }

 private:
  std::string MissingLabel(const daq::Record& record) const {
    if (by_class_) return ClassOf(record) ? "" : kClassLabel;
    for (const std::string& output : records_.outputs) {
      if (!LabelOf(record, output)) return output;
    }
    return "";
  }

  void TakeWindows(const daq::Record& record, SourceRows& rows) {
    const RecordSignals signals = SignalsOf(record, records_.signals);
    RequireAlive(record, signals, records_.signals.channels);
    const std::vector<Window> windows = WindowsOf(signals.rows(), signals.samples_per_turn, records_.window);
    if (windows.empty()) {
      throw RecordRefusal(
          record,
          fmt::format("{} samples (expected at least one window of {})", signals.rows(),
                      records_.window.turns > 0 ? fmt::format("{} turns", records_.window.turns)
                                                : fmt::format("{} samples", records_.window.samples)));
    }
    rows.operating.Include(OperatingPointOf(record));
    const Labels labels = LabelsOf(record);
    for (const Window& window : windows) {
      const std::vector<double> values = FeaturesOfWindow(record, signals, window, features_);
      rows.features.emplace_back(
          Eigen::Map<const Eigen::RowVectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
      rows.least_samples =
          rows.least_samples == 0 ? window.count : std::min(rows.least_samples, window.count);
      if (by_class_) {
        rows.classes.push_back(labels.name);
      } else {
        rows.targets.push_back(labels.values);
      }
    }
  }

  // What all windows of a record share.
  struct Labels {
    std::string name;  // of the class
    std::vector<double> values;
  };
  Labels LabelsOf(const daq::Record& record) const {
    if (by_class_) return {*ClassOf(record), {}};
    Labels labels;
    for (const std::string& output : records_.outputs) labels.values.push_back(*LabelOf(record, output));
    return labels;
  }

  const RecordFiles& records_;
  bool by_class_;
  ChannelFeatures features_;
};

}  // namespace

RecordFiles SurveyRecords(const std::vector<std::filesystem::path>& files, const SourceSettings& settings) {
  const std::vector<Facts> all = AllFacts(files, settings);
  RecordFiles records{
      .files = files,
      .outputs = settings.outputs.empty() ? OutputsOf(all) : settings.outputs,
      .signals = {settings.channels.empty() ? ChannelsOf(all.front()) : settings.channels,
                  settings.sample_rate_hz > 0.0 ? settings.sample_rate_hz : all.front().sample_rate_hz,
                  settings.sample_rate_hz > 0.0},
      .window = {},
      .warnings = WarningsOfAll(all)};
  if (records.outputs.empty()) {
    Refuse(files.front(), "no record has a label",
           fmt::format("metadata or a column with {} or class",
                       analysis::Listed(analysis::kPredictedQuantities, &analysis::Quantity::name)));
  }
  RequireAlike(all, settings, records.signals);
  records.window = WindowFor(all, settings, records.signals);
  return records;
}

std::vector<SourceRows> ReadRecordRows(const RecordFiles& records, const SourceSettings& settings,
                                       const SourceProgress& progress) {
  std::vector<std::vector<SourceRows>> of_file(records.files.size());
  const std::vector<std::string> names = ChannelFeatures(settings.features).Names(records.signals.channels);
  const SourceShape shape{records.signals.channels, names, names.size(), records.signals.sample_rate_hz};
  std::mutex telling;
  std::size_t done = 0;
  OverFiles(records.files, settings, [&](std::size_t i, const std::vector<daq::Record>& file) {
    RowTaker taker(records, settings);
    for (const daq::Record& record : file) {
      SourceRows rows;
      rows.source = records.files[i];
      rows.specimen = record.Metadata("specimen").value_or("");
      rows.shape = shape;
      taker.Take(record, rows);
      of_file[i].push_back(std::move(rows));
    }
    const std::lock_guard lock(telling);
    ++done;
    if (progress) progress(done, records.files.size());
  });
  std::vector<SourceRows> all;
  for (auto& rows : of_file) std::ranges::move(rows, std::back_inserter(all));
  return all;
}

}  // namespace strainwave::bench
