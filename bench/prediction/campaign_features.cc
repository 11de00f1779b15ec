// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/campaign_features.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/campaign.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/campaign/recompute.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/record_features.h"
#include "bench/prediction/record_operating_point.h"
#include "bench/prediction/record_windows.h"
#include "bench/records/record_data.h"
#include "daq/arrays_file.h"
#include "daq/data_file_error.h"
#include "daq/record_error.h"

namespace strainwave::bench {
namespace {

constexpr const char* kTorqueChannel = "output_torque_Nm";

// The features of one cycle, or why it has none.
struct CycleFeatures {
  std::vector<std::string> channels;
  std::vector<std::string> torque_channels;
  std::vector<double> values;
  double sample_rate_hz{};
  std::size_t samples{};
  OperatingPoint operating;
  std::string left_out;
};

const daq::Record* FindRecord(const std::vector<NamedRecord>& records, const daq::RecordKind& kind,
                              std::string_view column) {
  const auto found = std::ranges::find_if(records, [&](const NamedRecord& named) {
    return named.record.kind == kind && (column.empty() || named.record.FindColumn(column) != nullptr);
  });
  return found == records.end() ? nullptr : &found->record;
}

CycleFeatures FeaturesOf(const std::vector<NamedRecord>& records, bool motor_torque,
                         ChannelFeatures& features) {
  CycleFeatures cycle;
  const daq::Record* const found = FindRecord(records, daq::RecordKind::kVibration, "");
  if (found == nullptr) {
    cycle.left_out = "no vibration record";
    return cycle;
  }
  daq::Record vibration = *found;
  const daq::Record* const rotation = FindRecord(records, daq::RecordKind::kMotion, kTorqueChannel);
  if (rotation != nullptr) AddOperatingPoint(vibration, *rotation);
  if (motor_torque && rotation != nullptr) AddMotorTorque(vibration, *rotation);
  cycle.operating = OperatingPointOf(vibration);
  cycle.channels = VibrationChannelsOf(vibration);
  cycle.sample_rate_hz = SampleRateOf_hz(vibration);
  cycle.samples = vibration.rows();
  const RecordSignals signals = SignalsOf(vibration, {cycle.channels, cycle.sample_rate_hz, false});
  cycle.values = FeaturesOfWindow(vibration, signals, {0, signals.rows()}, features);
  if (rotation == nullptr) return cycle;
  cycle.torque_channels = {kTorqueChannel};
  std::vector<double> torque(features.CountPerChannel());
  std::optional<double> samples_per_turn = signals.samples_per_turn;
  if (samples_per_turn) *samples_per_turn *= SampleRateOf_hz(*rotation) / cycle.sample_rate_hz;
  features.Compute(rotation->CopyAsDoubles(kTorqueChannel), samples_per_turn, torque);
  cycle.values.insert(cycle.values.end(), torque.begin(), torque.end());
  return cycle;
}

daq::Attributes AttributesOf(const FeatureSettings& settings, bool motor_torque,
                             const CampaignFeatures& features) {
  return {{"wavelet", settings.wavelet.wavelet},
          {"mode", std::string(analysis::wavelets::NameOf(settings.wavelet.border))},
          {"levels", std::to_string(settings.wavelet.levels)},
          {"orders", fmt::format("{}", fmt::join(settings.orders.edges, " "))},
          {"motor_torque", motor_torque ? "added" : "as recorded"},
          {"channels", fmt::format("{}", fmt::join(features.channels, " "))},
          {"torque_channels", fmt::format("{}", fmt::join(features.torque_channels, " "))},
          {"sample_rate_hz", daq::ShortestText(features.sample_rate_hz)},
          {"least_samples", std::to_string(features.least_samples)},
          {"operating_envelope", features.operating.Json().dump()}};
}

std::vector<std::string> Words(const std::string& text) {
  std::vector<std::string> words;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    if (end > begin) words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

std::vector<std::string> NamesOf(const CampaignFeatures& features, const ChannelFeatures& channel_features) {
  std::vector<std::string> names = channel_features.Names(features.channels);
  const std::vector<std::string> torque = channel_features.Names(features.torque_channels);
  names.insert(names.end(), torque.begin(), torque.end());
  return names;
}

// What an earlier call has kept, if it was made with this recipe; a file that cannot be used is made anew.
std::optional<CampaignFeatures> Kept(const std::filesystem::path& store, const FeatureSettings& settings,
                                     bool motor_torque, const ChannelFeatures& channel_features) {
  if (!std::filesystem::exists(store)) return std::nullopt;
  try {
    const daq::ArraysFile file = daq::ReadArrays(store);
    const std::map<std::string, std::string> attributes(file.attributes.begin(), file.attributes.end());
    CampaignFeatures kept;
    kept.channels = Words(attributes.at("channels"));
    kept.torque_channels = Words(attributes.at("torque_channels"));
    kept.sample_rate_hz = daq::NumberFromText(attributes.at("sample_rate_hz")).value();
    kept.least_samples =
        static_cast<std::size_t>(daq::NumberFromText(attributes.at("least_samples")).value());
    kept.operating =
        OperatingEnvelope::From(nlohmann::ordered_json::parse(attributes.at("operating_envelope")));
    if (file.attributes != AttributesOf(settings, motor_torque, kept)) return std::nullopt;
    kept.names = NamesOf(kept, channel_features);
    const daq::NamedArray* const cycle = file.Find("cycle");
    if (cycle == nullptr || file.arrays.size() != kept.names.size() + 1) return std::nullopt;
    for (const double number : cycle->values) kept.cycle.push_back(static_cast<int>(number));
    kept.values.resize(static_cast<Eigen::Index>(kept.cycle.size()),
                       static_cast<Eigen::Index>(kept.names.size()));
    for (std::size_t column = 0; column < kept.names.size(); ++column) {
      const daq::NamedArray& array = file.arrays[column + 1];
      if (array.name != kept.names[column] || array.values.size() != kept.cycle.size()) return std::nullopt;
      kept.values.col(static_cast<Eigen::Index>(column)) =
          Eigen::Map<const Eigen::VectorXd>(array.values.data(), kept.values.rows());
    }
    return kept;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

// Why they could not be kept, as of a campaign on a disk that cannot be written; empty: they are.
std::string Keep(const std::filesystem::path& store, const FeatureSettings& settings, bool motor_torque,
                 const CampaignFeatures& features) {
  daq::ArraysFile file{.attributes = AttributesOf(settings, motor_torque, features), .arrays = {}};
  const std::vector<std::size_t> shape{features.cycle.size()};
  file.arrays.push_back({"cycle", shape, {features.cycle.begin(), features.cycle.end()}});
  for (std::size_t column = 0; column < features.names.size(); ++column) {
    const auto values = features.values.col(static_cast<Eigen::Index>(column));
    file.arrays.push_back({features.names[column], shape, {values.begin(), values.end()}});
  }
  try {
    daq::WriteArraysAtomically(store, file);
    return "";
  } catch (const daq::DataFileError& error) {
    return error.what();
  }
}

// Features of the cycles named, on all processors; HDF5 and the journal are read by one thread at a time.
std::vector<CycleFeatures> Compute(const CampaignFolder& folder, const Journal& journal,
                                   const std::vector<int>& cycles, const FeatureSettings& settings,
                                   bool motor_torque, const FeatureProgress& progress) {
  std::vector<CycleFeatures> results(cycles.size());
  std::size_t done = 0;
  std::mutex files;
  std::mutex reporting;
  OnAllProcessors(cycles.size(), [&](std::size_t i) {
    try {
      std::vector<NamedRecord> records;
      {
        const std::lock_guard reading(files);
        records = ReadCycleRecords(folder, journal, cycles[i]);
      }
      ChannelFeatures features(settings);
      results[i] = FeaturesOf(records, motor_torque, features);
    } catch (const std::exception& error) {
      results[i].left_out = error.what();
    }
    const std::lock_guard telling(reporting);
    ++done;
    if (progress) progress(done, cycles.size());
  });
  return results;
}

// Adds the cycles that are like those before; the first one says what all must be like.
void Append(CampaignFeatures& all, const std::vector<int>& cycles, std::vector<CycleFeatures> computed,
            const ChannelFeatures& channel_features) {
  std::vector<Eigen::RowVectorXd> rows;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    CycleFeatures& one = computed[i];
    if (one.left_out.empty() && all.channels.empty()) {
      all.channels = one.channels;
      all.torque_channels = one.torque_channels;
      all.sample_rate_hz = one.sample_rate_hz;
      all.least_samples = one.samples;
    }
    if (one.left_out.empty() && (one.channels != all.channels || one.torque_channels != all.torque_channels ||
                                 one.sample_rate_hz != all.sample_rate_hz)) {
      one.left_out = fmt::format("channels {} at {} Hz (expected {} at {} Hz, as in the cycles before)",
                                 fmt::join(one.channels, " "), one.sample_rate_hz,
                                 fmt::join(all.channels, " "), all.sample_rate_hz);
    }
    if (!one.left_out.empty()) {
      all.notes.push_back(fmt::format("cycle {} left out: {}", cycles[i], one.left_out));
      continue;
    }
    all.least_samples = std::min(all.least_samples, one.samples);
    all.operating.Include(one.operating);
    all.cycle.push_back(cycles[i]);
    rows.emplace_back(Eigen::Map<const Eigen::RowVectorXd>(one.values.data(),
                                                           static_cast<Eigen::Index>(one.values.size())));
  }
  all.names = NamesOf(all, channel_features);
  const Eigen::Index before = all.values.rows();
  all.values.conservativeResize(before + static_cast<Eigen::Index>(rows.size()),
                                static_cast<Eigen::Index>(all.names.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    all.values.row(before + static_cast<Eigen::Index>(i)) = rows[i];
}

}  // namespace

std::filesystem::path FeaturesFile(const std::filesystem::path& folder, FeatureSet set) {
  return folder / (set == FeatureSet::kWavelet ? "features.h5" : fmt::format("features_{}.h5", NameOf(set)));
}

CampaignFeatures FeaturesOfCampaign(const std::filesystem::path& path, const FeatureSettings& settings,
                                    bool motor_torque, const FeatureProgress& progress) {
  const CampaignFolder folder{path};
  if (!std::filesystem::exists(folder.Journal())) {
    Refuse(path, "is not a campaign", "a folder with campaign.db");
  }
  const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly);
  const ChannelFeatures channel_features(settings);
  const std::filesystem::path store = FeaturesFile(path, settings.set);
  CampaignFeatures all = Kept(store, settings, motor_torque, channel_features).value_or(CampaignFeatures{});
  std::vector<int> missing;
  for (const CycleRow& row : journal.Cycles()) {
    if (row.outcome == "complete" && row.cycle > 0 &&
        std::ranges::find(all.cycle, row.cycle) == all.cycle.end()) {
      missing.push_back(row.cycle);
    }
  }
  if (!missing.empty()) {
    Append(all, missing, Compute(folder, journal, missing, settings, motor_torque, progress),
           channel_features);
    if (!all.cycle.empty()) all.not_kept = Keep(store, settings, motor_torque, all);
  }
  if (all.cycle.empty()) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: no complete cycle has a vibration record (expected measurement "
                                 "rotations with vibration_rate){}",
                                 path.string(), all.notes.empty() ? "" : "; " + all.notes.front()));
  }
  return all;
}

}  // namespace strainwave::bench
