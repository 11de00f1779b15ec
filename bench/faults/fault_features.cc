// SPDX-License-Identifier: Apache-2.0
#include "bench/faults/fault_features.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/prediction/ensemble.h"
#include "analysis/units.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/record_features.h"
#include "bench/prediction/record_windows.h"
#include "bench/records/record_refusal.h"
#include "bench/records/vibration_channels.h"

namespace strainwave::bench {
namespace {

namespace features = analysis::features;

constexpr double kFewestTurns = 4.0;

// A record that was read, until its features are there.
struct Pending {
  std::size_t row{};  // of the labels
  std::vector<std::vector<double>> channels;
  std::optional<double> samples_per_turn;
  std::vector<std::vector<double>> details;  // one a recipe
  std::vector<double> by_order;              // as many bands as its own sampling reaches
  std::size_t samples{};
};

void Compute(std::span<const features::DetailRecipe> recipes, Pending& record) {
  record.samples = record.channels.front().size();
  for (const features::DetailRecipe& recipe : recipes) {
    features::DetailDeviations by_detail(recipe);
    const std::size_t levels = by_detail.CountPerChannel();
    std::vector<double>& details = record.details.emplace_back(record.channels.size() * levels);
    for (std::size_t c = 0; c < record.channels.size(); ++c)
      by_detail.Compute(record.channels[c], std::span(details).subspan(c * levels, levels));
  }
  const bool turns = record.samples_per_turn &&
                     static_cast<double>(record.samples) >= kFewestTurns * *record.samples_per_turn - 1.0;
  if (turns) {
    const features::OrderBands bands = features::EnvelopeOrderBands(*record.samples_per_turn);
    for (const std::vector<double>& channel : record.channels) {
      if (bands.edges.empty()) break;
      const std::vector<double> shares =
          features::EnvelopeOrderShares(channel, *record.samples_per_turn, bands);
      record.by_order.insert(record.by_order.end(), shares.begin(), shares.end());
    }
  }
  record.channels.clear();
}

// Of channels side by side the first `kept` values each.
template <typename ValuesOf>
Eigen::MatrixXd FirstOfEach(const std::vector<Pending>& records, const ValuesOf& values_of,
                            std::size_t channels, std::size_t kept) {
  Eigen::MatrixXd table(static_cast<Eigen::Index>(records.size()),
                        static_cast<Eigen::Index>(channels * kept));
  for (std::size_t r = 0; r < records.size(); ++r) {
    const std::vector<double>& own = values_of(records[r]);
    const std::size_t per_channel = own.size() / channels;
    for (std::size_t c = 0; c < channels; ++c) {
      for (std::size_t k = 0; k < kept; ++k)
        table(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c * kept + k)) =
            own[c * per_channel + k];
    }
  }
  return table;
}

// The labels of the rows that were kept.
FaultLabels Kept(const FaultLabels& labels, const std::vector<Pending>& records) {
  FaultLabels kept;
  kept.outputs = labels.outputs;
  kept.labels = labels.labels;
  kept.limits = labels.limits;
  kept.targets.resize(static_cast<Eigen::Index>(records.size()), labels.targets.cols());
  for (const FaultLabels::Group& group : labels.groups) kept.groups.push_back({group.column, {}});
  for (std::size_t r = 0; r < records.size(); ++r) {
    const std::size_t row = records[r].row;
    kept.rows.push_back(labels.rows[row]);
    kept.unit.push_back(labels.unit[row]);
    kept.targets.row(static_cast<Eigen::Index>(r)) = labels.targets.row(static_cast<Eigen::Index>(row));
    for (std::size_t g = 0; g < kept.groups.size(); ++g)
      kept.groups[g].value.push_back(labels.groups[g].value[row]);
  }
  return kept;
}

// By the recipe in place `which`, with as many levels as fit.
FaultTable DetailsOf(const std::vector<Pending>& records, const features::DetailRecipe& recipe,
                     std::size_t which, const std::vector<std::string>& channels, int most) {
  FaultTable table;
  table.settings.set = FeatureSet::kDetails;
  table.settings.details = recipe;
  table.settings.details.levels = std::min(most, recipe.levels);
  table.least_samples = std::ranges::min(records, {}, &Pending::samples).samples;
  table.names = features::DetailDeviations(table.settings.details).Names(channels);
  table.values = FirstOfEach(
      records, [which](const Pending& one) -> const std::vector<double>& { return one.details[which]; },
      channels.size(), static_cast<std::size_t>(table.settings.details.levels));
  return table;
}

void AddDetails(const std::vector<Pending>& records, std::span<const features::DetailRecipe> recipes,
                FaultRecords& result) {
  const auto shortest = std::ranges::min_element(records, {}, &Pending::samples);
  const std::string& file = result.files[static_cast<std::size_t>(shortest - records.begin())];
  for (std::size_t which = 0; which < recipes.size(); ++which) {
    const features::DetailRecipe& recipe = recipes[which];
    const std::size_t filter = analysis::wavelets::FilterBankOf(recipe.wavelet).length();
    const int most = features::MostDetailLevels(shortest->samples, filter);
    if (which > 0 && most > 0)
      result.other_wavelets.push_back(DetailsOf(records, recipe, which, result.channels, most));
    if (which > 0) continue;
    if (most == 0)
      Refuse(file, fmt::format("{} samples: not one level of {} fits", shortest->samples, recipe.wavelet),
             fmt::format("{} samples or more", 2 * (filter - 1)));
    if (most < recipe.levels)
      result.notes.push_back(
          fmt::format("details of {} levels in place of {}: no more of {} fit into the {} samples of {}",
                      most, recipe.levels, recipe.wavelet, shortest->samples, file));
    result.tables.push_back(DetailsOf(records, recipe, which, result.channels, most));
  }
}

void AddOrders(const std::vector<Pending>& records, FaultRecords& result) {
  const auto known = std::ranges::count_if(records, [](const Pending& one) { return !one.by_order.empty(); });
  const auto all = static_cast<std::ptrdiff_t>(records.size());
  if (known < all) {
    result.notes.push_back(
        known == 0
            ? "orders of the envelope are not looked at: no record tells a steady speed (input_speed_rpm, in "
              "the record or in labels.csv) over 4 turns or more"
            : fmt::format(
                  "orders of the envelope are not looked at: {} of {} records tell no steady speed over "
                  "4 turns or more",
                  all - known, all));
    return;
  }
  std::size_t bands = std::numeric_limits<std::size_t>::max();
  double turns = std::numeric_limits<double>::infinity();
  double samples_per_turn = std::numeric_limits<double>::infinity();
  for (const Pending& one : records) {
    bands = std::min(bands, one.by_order.size() / result.channels.size());
    turns = std::min(turns, (static_cast<double>(one.samples) + 1.0) / *one.samples_per_turn);
    samples_per_turn = std::min(samples_per_turn, *one.samples_per_turn);
  }
  FaultTable table;
  table.settings.set = FeatureSet::kEnvelopeOrders;
  table.settings.orders.edges = {0.25};
  for (std::size_t k = 0; k < bands; ++k)
    table.settings.orders.edges.push_back(0.75 + 0.5 * static_cast<double>(k));
  table.turns = static_cast<int>(turns);
  table.least_samples = static_cast<std::size_t>(table.turns * samples_per_turn);
  table.names = features::EnvelopeOrderNames(result.channels, table.settings.orders);
  table.values = FirstOfEach(
      records, [](const Pending& one) -> const std::vector<double>& { return one.by_order; },
      result.channels.size(), bands);
  result.tables.push_back(std::move(table));
}

// Of a record: its channels at the common rate, or nothing where a sensor was dead.
std::optional<Pending> Take(const daq::Record& record, std::size_t row, std::optional<double> speed_rpm,
                            FaultRecords& result) {
  if (result.channels.empty()) {
    result.channels = SortVibrationColumns(record).channels;
    if (result.channels.empty())
      throw RecordRefusal(record,
                          "there is no channel (expected one column or more, such as accel_x_m_per_s2)");
    result.sample_rate_hz = SampleRateOf_hz(record);
  }
  const double rate_hz = SampleRateOf_hz(record);
  const SignalSettings settings{result.channels, result.sample_rate_hz, true};
  const int factor = DecimationFactor(rate_hz, settings);
  RecordSignals signals = SignalsOf(record, settings);
  if (factor > 1) result.decimates = true;
  for (std::size_t c = 0; c < signals.channels.size(); ++c) {
    const auto fault = SensorFault(result.channels[c], signals.channels[c]);
    if (!fault) continue;
    const bool dead = fault->kind != SignalFaultKind::kClipped;
    result.notes.push_back(
        fmt::format("{}: {}{}", record.source.file, fault->text, dead ? "; left out" : ""));
    if (dead) return std::nullopt;
  }
  return Pending{.row = row,
                 .channels = std::move(signals.channels),
                 .samples_per_turn = SamplesPerTurnOf(record, rate_hz / factor, speed_rpm),
                 .details = {},
                 .by_order = {}};
}

void RequireEnough(const Labels& table, const FaultRecords& result) {
  constexpr Eigen::Index kFewest = 4;
  const FaultLabels& labels = result.labels;
  const Eigen::RowVectorXd sums = labels.targets.colwise().sum();
  const auto there = (sums.array() > 0.5).count();
  if (labels.targets.rows() >= kFewest && (labels.labels || there >= 2)) return;
  Refuse(
      table.path(),
      fmt::format("{} records of {} {}{}", labels.targets.rows(), there, labels.labels ? "faults" : "classes",
                  result.notes.empty() ? "" : "; " + result.notes.front()),
      fmt::format("{} records or more, of two classes or more", kFewest));
}

}  // namespace

std::optional<double> SamplesPerTurnOf(const daq::Record& record, double rate_hz,
                                       std::optional<double> speed_rpm) {
  if (const auto own_rad_per_s = SteadyInputSpeedOf_rad_per_s(record))
    return rate_hz * kTwoPi / *own_rad_per_s;
  if (speed_rpm && std::abs(*speed_rpm) > 0.0) return rate_hz * 60.0 / std::abs(*speed_rpm);
  return std::nullopt;
}

FaultRecords ReadFaultRecords(const Labels& table, FaultLabels labels, const features::DetailRecipe& details,
                              const std::vector<std::string>& other_wavelets,
                              const std::vector<double>& speed_rpm, const RecordReader& reader,
                              const FaultReadingProgress& progress) {
  std::vector<features::DetailRecipe> recipes{details};
  for (const std::string& wavelet : other_wavelets) {
    recipes.push_back(details);
    recipes.back().wavelet = wavelet;
  }
  constexpr std::size_t kAtOnce = 64;  // in memory
  FaultRecords result;
  std::vector<Pending> records;
  std::size_t computed = 0;
  const auto compute = [&] {
    OnAllProcessors(records.size() - computed,
                    [&](std::size_t k) { Compute(recipes, records[computed + k]); });
    computed = records.size();
  };
  for (std::size_t row = 0; row < labels.rows.size(); ++row) {
    const Labels::Row& at = table.rows()[labels.rows[row]];
    std::optional<double> speed;
    if (!speed_rpm.empty()) speed = speed_rpm[labels.rows[row]];
    for (const daq::Record& record : ReadVibrationRecords(at.file, MotorTorque::kAsRecorded, reader)) {
      std::vector<RecordWarning> warnings = WarningsOf(record);
      std::ranges::move(warnings, std::back_inserter(result.warnings));
      auto pending = Take(record, row, speed, result);
      if (!pending) continue;
      records.push_back(std::move(*pending));
      result.files.push_back(at.name);
    }
    if (records.size() - computed >= kAtOnce) compute();
    if (!progress(row + 1, labels.rows.size())) throw analysis::prediction::TrainingEnded();
  }
  compute();
  result.labels = Kept(labels, records);
  RequireEnough(table, result);
  AddDetails(records, recipes, result);
  AddOrders(records, result);
  return result;
}

}  // namespace strainwave::bench
