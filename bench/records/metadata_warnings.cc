// SPDX-License-Identifier: Apache-2.0
#include "bench/records/metadata_warnings.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "analysis/quantities.h"
#include "daq/record_rules.h"
#include "daq/value_bounds.h"
#include "schedules/reader/wording.h"

namespace strainwave::bench {
namespace {

using Keys = std::span<const std::string_view>;

// What an analysis reads of each kind.
constexpr std::array<std::string_view, 2> kOfSweep{"ratio", "absolute"};
constexpr std::array<std::string_view, 3> kOfLoop{"t1_Nm", "t2_Nm", "t3_Nm"};
constexpr std::array<std::string_view, 2> kOfMotion{"inertia_kgm2", "mass_kg"};
constexpr std::array kOfVibration = [] {
  std::array<std::string_view, 5 + analysis::kPredictedQuantities.size()> keys{
      "sample_rate_hz", "input_speed_rpm", "ratio", "class", "specimen"};
  std::ranges::transform(analysis::kPredictedQuantities, keys.begin() + 5, &analysis::Quantity::name);
  return keys;
}();

// What the bench and simulate write beside it, and what says whose the record is.
constexpr std::array<std::string_view, 23> kOfAll{"absolute",
                                                  "check",
                                                  "class",
                                                  "credited_load_s",
                                                  "direction",
                                                  "encoder_skew_se_us",
                                                  "encoder_skew_taken_out",
                                                  "encoder_skew_us",
                                                  "input_speed_rpm",
                                                  "lock_angle_deg",
                                                  "log_rate_hz",
                                                  "lost_samples",
                                                  "recording",
                                                  "sample_rate_hz",
                                                  "simulated_model",
                                                  "simulated_seed",
                                                  "source",
                                                  "specimen",
                                                  "statistics",
                                                  "step_deg",
                                                  "stop_cause",
                                                  "stop_time_s",
                                                  "trouble"};

Keys KeysOf(const daq::RecordKind& kind) {
  if (kind == daq::RecordKind::kTransmissionError) return kOfSweep;
  if (kind == daq::RecordKind::kHysteresis) return kOfLoop;
  if (kind == daq::RecordKind::kMotion) return kOfMotion;
  if (kind == daq::RecordKind::kVibration) return kOfVibration;
  return {};
}

bool IsGain(std::string_view key) { return key.ends_with("_Nm_per_A") || key.ends_with("_N_per_A"); }

// "T1 [Nm]" as "t1_nm".
std::string Plain(std::string_view key) {
  std::string plain;
  for (const char c : key) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (c >= 'A' && c <= 'Z') {
      plain += static_cast<char>(c - 'A' + 'a');
    } else if (letter) {
      plain += c;
    } else if (!plain.empty() && plain.back() != '_') {
      plain += '_';
    }
  }
  while (plain.ends_with('_')) plain.pop_back();
  return plain;
}

// Without its unit: "t1" of "t1_Nm".
std::string_view Stem(std::string_view key) { return key.substr(0, key.rfind('_')); }

std::optional<std::string> Meant(std::string_view key, Keys keys) {
  const std::string plain = Plain(key);
  std::vector<std::string> plain_keys;
  for (const std::string_view known : keys) plain_keys.push_back(Plain(known));
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const std::string stem = Plain(Stem(keys[i]));
    // The unit left out, another unit, or a word before it: "t1", "t1_kNm", "gear_ratio".
    if (plain == plain_keys[i] || plain == stem || plain.starts_with(stem + "_") ||
        plain.ends_with("_" + plain_keys[i]))
      return std::string(keys[i]);
  }
  const std::vector<std::string_view> words(plain_keys.begin(), plain_keys.end());
  const std::optional<std::string> nearest = schedules::NearestWord(plain, words);
  if (!nearest) return std::nullopt;
  return std::string(
      keys[static_cast<std::size_t>(std::ranges::find(plain_keys, *nearest) - plain_keys.begin())]);
}

void AddDefaults(const daq::Record& record, std::vector<std::string>& warnings) {
  // The ratio of a vibration is asked for by diagnose alone.
  if (record.kind != daq::RecordKind::kTransmissionError && record.kind != daq::RecordKind::kHysteresis)
    return;
  for (const std::string_view key : KeysOf(record.kind)) {
    if (record.Metadata(key)) continue;
    const std::optional<double> taken = daq::MetadataNumber(record, key);
    if (!taken) continue;
    const std::string unit =
        daq::BoundsOf(key).unit.empty() ? "" : fmt::format(" {}", daq::BoundsOf(key).unit);
    warnings.push_back(
        fmt::format("metadata {} is missing: the default of {:g}{} is taken", key, *taken, unit));
  }
}

}  // namespace

std::vector<std::string> MetadataWarnings(const daq::Record& record) {
  std::vector<std::string> warnings;
  AddDefaults(record, warnings);
  const Keys read = KeysOf(record.kind);
  for (const auto& [key, value] : record.metadata) {
    if (std::ranges::find(read, key) != read.end() || std::ranges::find(kOfAll, key) != kOfAll.end() ||
        key == "ratio" || IsGain(key))
      continue;
    std::vector<std::string_view> missing;
    for (const std::string_view known : read)
      if (!record.Metadata(known)) missing.push_back(known);
    if (const auto meant = Meant(key, missing)) {
      warnings.push_back(
          fmt::format("metadata '{}' is not known and not read; did you mean '{}'?", key, *meant));
    } else if (record.kind != daq::RecordKind::kVibration) {
      warnings.push_back(fmt::format("metadata '{}' is not known and not read", key));
    }
  }
  return warnings;
}

}  // namespace strainwave::bench
