// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/cycle_results.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/core.h>

#include "analysis/units.h"
#include "bench/campaign/acquisition_results.h"
#include "bench/campaign/check_results.h"
#include "bench/campaign/load_results.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/campaign/rotation_results.h"

namespace strainwave::bench {
namespace {

using analysis::Estimate;
using analysis::Quantity;
using analysis::StiffnessMethod;
namespace quantities = analysis::quantities;

struct Place {
  std::string phase;
  std::string record;
  int retry{};
};

// "PHASE/RECORD" or "PHASE/retry_N/RECORD".
Place PlaceOf(const std::string& group) {
  Place place;
  const std::size_t last = group.rfind('/');
  place.record = last == std::string::npos ? group : group.substr(last + 1);
  place.phase = last == std::string::npos ? std::string() : group.substr(0, last);
  const std::size_t retry = place.phase.rfind("/retry_");
  if (retry != std::string::npos) {
    place.retry = std::stoi(place.phase.substr(retry + 7));
    place.phase.resize(retry);
  }
  return place;
}

// The records that count, in an order that does not depend on how they came.
std::vector<const daq::Record*> Counting(std::span<const NamedRecord> records, const daq::RecordKind& kind) {
  std::map<std::pair<std::string, std::string>, std::pair<int, const daq::Record*>> newest;
  for (const NamedRecord& named : records) {
    if (named.record.kind != kind) continue;
    const Place place = PlaceOf(named.group);
    auto& entry = newest[{place.phase, place.record}];
    if (entry.second == nullptr || entry.first < place.retry) entry = {place.retry, &named.record};
  }
  std::vector<const daq::Record*> counting;
  for (const auto& [key, entry] : newest) counting.push_back(entry.second);
  return counting;
}

class Results {
 public:
  explicit Results(CycleAnalysis& analysis) : analysis_(analysis) {}

  void Add(std::string_view quantity, const Estimate& estimate, const std::string& flag) {
    analysis_.results.push_back({std::string(quantity), estimate.value, estimate.standard_error, flag});
  }
  void AddArcmin(const Quantity& quantity, const Estimate& angle_rad, const CycleContext& context,
                 const std::string& flag) {
    const Estimate arcmin{ArcminFromRad(angle_rad.value), ArcminFromRad(angle_rad.standard_error)};
    Add(quantity.name, WithEncoderUncertainty(arcmin, quantity, context.corrections), flag);
  }
  // Why the numbers of a measurement are not good; empty when they are.
  std::string Flag(const std::vector<std::string>& failed_checks, const std::string& measurement) {
    std::string flag;
    for (const std::string& check : failed_checks) {
      analysis_.failed_checks.push_back(fmt::format("{}: {}", measurement, check));
      flag += (flag.empty() ? "" : "; ") + check;
    }
    return flag;
  }

 private:
  CycleAnalysis& analysis_;
};

double Mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? std::nan("") : sum / static_cast<double>(values.size());
}

std::string WithThermalFlag(std::string flag, const daq::Record& record, const CycleContext& context) {
  const double temperature_degC = Mean(record.Doubles("temperature_degC"));
  if (std::abs(temperature_degC - context.declared_temperature_degC) <= context.temperature_tolerance_K)
    return flag;
  if (!flag.empty()) return flag;
  return fmt::format("{} at {:.1f} degC, declared are {:.1f} ± {:.1f} degC", kThermalFlag, temperature_degC,
                     context.declared_temperature_degC, context.temperature_tolerance_K);
}

void AddTransmissionError(const daq::Record& record, const analysis::TransmissionError& error,
                          const CycleContext& context, CycleAnalysis& analysis) {
  Results results(analysis);
  const std::string flag =
      WithThermalFlag(results.Flag(error.failed_checks, "transmission error"), record, context);
  if (error.cw) {
    results.AddArcmin(quantities::kEAvg, error.cw->e_avg_rad, context, flag);
    results.AddArcmin(quantities::kEMax, error.cw->e_max_rad, context, flag);
  }
  if (error.ccw) {
    results.AddArcmin(quantities::kEAvgCcw, error.ccw->e_avg_rad, context, flag);
    results.AddArcmin(quantities::kEMaxCcw, error.ccw->e_max_rad, context, flag);
  }
  if (const auto skew_us = daq::NumberFromText(record.Metadata("encoder_skew_us").value_or(""))) {
    const auto se_us = daq::NumberFromText(record.Metadata("encoder_skew_se_us").value_or(""));
    results.Add(quantities::kEncoderSkew.name, {*skew_us, se_us.value_or(0.0)}, "");
  }
  if (error.lost_motion_rad)
    results.AddArcmin(quantities::kLostMotion, *error.lost_motion_rad, context, flag);
  analysis.transmission_error = error;
}

// Mean of independent estimates.
Estimate MeanOf(std::span<const analysis::TorsionalStiffness> loops,
                Estimate analysis::TorsionalStiffness::*field) {
  Estimate mean;
  for (const auto& loop : loops) {
    mean.value += (loop.*field).value;
    mean.standard_error += (loop.*field).standard_error * (loop.*field).standard_error;
  }
  const double count = static_cast<double>(loops.size());
  return {mean.value / count, std::sqrt(mean.standard_error) / count};
}

void AddStiffness(std::span<const daq::Record* const> loops, StiffnessMethod method,
                  std::span<const analysis::TorsionalStiffness> fits, const CycleContext& context,
                  CycleAnalysis& analysis) {
  Results results(analysis);
  std::string flag;
  const bool main_method = method == context.method;
  // The other two are shown beside the chosen one; their checks are the same record's.
  if (main_method) {
    for (const auto& fit : fits) flag += results.Flag(fit.failed_checks, "hysteresis");
  }
  if (main_method) flag = WithThermalFlag(std::move(flag), *loops.front(), context);
  std::string k_flag = flag;
  if (main_method && !KnowsCompliance(context.corrections))
    k_flag += fmt::format("{}{}", flag.empty() ? "" : "; ", kNoBlankFlag);
  const auto add = [&](const Quantity& of_main, Estimate analysis::TorsionalStiffness::*field) {
    const std::string quantity =
        main_method ? std::string(of_main.name) : NameByMethod(of_main, NameOf(method));
    results.Add(quantity, WithBenchUncertainty(MeanOf(fits, field), quantity, context.corrections), k_flag);
  };
  add(quantities::kK1, &analysis::TorsionalStiffness::k1_Nm_per_rad);
  add(quantities::kK2, &analysis::TorsionalStiffness::k2_Nm_per_rad);
  add(quantities::kK3, &analysis::TorsionalStiffness::k3_Nm_per_rad);
  if (!main_method) return;
  results.AddArcmin(quantities::kHysteresis, MeanOf(fits, &analysis::TorsionalStiffness::hysteresis_rad),
                    context, flag);
  results.AddArcmin(quantities::kHysteresisLostMotion,
                    MeanOf(fits, &analysis::TorsionalStiffness::lost_motion_rad), context, flag);
  analysis.stiffness = fits.front();
  analysis.loop = loops.front();
}

// The context's method first.
std::vector<StiffnessMethod> MethodsOf(const CycleContext& context) {
  std::vector<StiffnessMethod> methods{context.method};
  for (const StiffnessMethod method : analysis::kStiffnessMethods) {
    if (method != context.method) methods.push_back(method);
  }
  return methods;
}

}  // namespace

CycleAnalysis AnalyzeCycle(std::span<const NamedRecord> records, const CycleContext& context) {
  const auto sweeps = Counting(records, daq::RecordKind::kTransmissionError);
  const auto loops = Counting(records, daq::RecordKind::kHysteresis);
  const std::vector<StiffnessMethod> methods = MethodsOf(context);
  // What takes long, on all processors; then everything in one order.
  std::vector<analysis::TorsionalStiffness> fits(methods.size() * loops.size());
  std::vector<analysis::TransmissionError> errors(sweeps.size());
  OnAllProcessors(fits.size() + errors.size(), [&](std::size_t i) {
    if (i < fits.size()) {
      fits[i] = StiffnessOf(*loops[i % loops.size()], methods[i / loops.size()], context.corrections);
    } else {
      errors[i - fits.size()] = TransmissionErrorOf(*sweeps[i - fits.size()], context.corrections);
    }
  });
  CycleAnalysis analysis;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    AddTransmissionError(*sweeps[i], errors[i], context, analysis);
  }
  if (!loops.empty()) {
    for (std::size_t m = 0; m < methods.size(); ++m) {
      AddStiffness(loops, methods[m], std::span(fits).subspan(m * loops.size(), loops.size()), context,
                   analysis);
    }
    analysis.results.push_back({std::string(quantities::kGearTemperature.name),
                                Mean(loops.front()->Doubles("temperature_degC")), 0.0, ""});
  }
  for (const daq::Record* record : Counting(records, daq::RecordKind::kMotion)) {
    for (Result& result : RotationResults(*record, context.ratio))
      analysis.results.push_back(std::move(result));
  }
  for (const daq::Record* record : Counting(records, daq::RecordKind::kVibration)) {
    for (Result& result : VibrationResults(*record)) analysis.results.push_back(std::move(result));
  }
  for (Result& result : SensorCheckResults(records)) analysis.results.push_back(std::move(result));
  for (Result& result : VibrationStatisticsResults(records)) analysis.results.push_back(std::move(result));
  for (Result& result : LoadResults(records)) analysis.results.push_back(std::move(result));
  return analysis;
}

bool IsSound(const Result& result) {
  return std::isfinite(result.value) && (result.flag.empty() || result.flag.starts_with(kThermalFlag) ||
                                         result.flag.starts_with(kNoBlankFlag));
}

std::vector<Result> SensorCheckResults(std::span<const NamedRecord> records) {
  std::vector<Result> results;
  for (const NamedRecord& named : records) {
    if (!IsSensorCheck(named.record)) continue;
    results.push_back(SensorCheckResult(named.record, PlaceOf(named.group).phase));
  }
  return results;
}

std::optional<Result> FindResult(std::span<const Result> results, std::string_view quantity) {
  const auto found = std::ranges::find(results, quantity, &Result::quantity);
  if (found == results.end()) return std::nullopt;
  return *found;
}

}  // namespace strainwave::bench
