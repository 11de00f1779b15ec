// SPDX-License-Identifier: Apache-2.0
#include "bench/page/measurements.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>

#include <fmt/core.h>

#include "analysis/amplitude_spectrum.h"
#include "analysis/one_turn.h"
#include "analysis/units.h"
#include "bench/campaign/campaign.h"
#include "daq/record.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

constexpr std::size_t kMostPoints = 1200;  // twice the pixels of a chart
constexpr std::string_view kAcceleration = "_m_per_s2";

// To six digits: more than a picture shows.
json Numbers(const std::vector<double>& values) {
  json numbers = json::array();
  for (const double value : values) {
    numbers.push_back(std::isfinite(value) ? json(std::stod(fmt::format("{:.6g}", value))) : json());
  }
  return numbers;
}

json CurveJson(const PlotCurve& curve, const char* x, const char* y) {
  const PlotCurve thinned = Thinned(curve, kMostPoints);
  return {{x, Numbers(thinned.x)}, {y, Numbers(thinned.y)}};
}

json LoopJson(const CycleCurves& curves) {
  if (curves.analysis.loop == nullptr || curves.torque_Nm.empty()) return {};
  PlotCurve loop{curves.torque_Nm, {}};
  for (const double twist_rad : curves.twist_rad) loop.y.push_back(ArcminFromRad(twist_rad));
  json loop_json = CurveJson(loop, "torque_Nm", "twist_arcmin");
  const auto angle = curves.analysis.loop->Metadata("lock_angle_deg");
  loop_json["lock_angle_deg"] = angle ? json(daq::NumberFromText(*angle).value_or(0.0)) : json();
  return loop_json;
}

json TurnJson(const std::optional<analysis::SweepError>& sweep) {
  if (!sweep) return {};
  analysis::TurnCurve turn = analysis::OneTurn(*sweep);
  return CurveJson({std::move(turn.angle_deg), std::move(turn.error_arcmin)}, "angle_deg", "error_arcmin");
}

// Of the newest record with accelerations that says how fast it was sampled.
json SpectrumJson(const std::vector<NamedRecord>& records) {
  json spectra = json::object();
  for (const NamedRecord& named : records) {
    const auto rate = named.record.Metadata("sample_rate_hz");
    const auto rate_Hz = rate ? daq::NumberFromText(*rate) : std::nullopt;
    if (!rate_Hz || !(*rate_Hz > 0.0)) continue;
    json of_record = json::object();
    for (const daq::Column& column : named.record.columns) {
      if (!std::string_view(column.name).ends_with(kAcceleration)) continue;
      auto spectrum = analysis::AmplitudeSpectrumOf(named.record.CopyAsDoubles(column.name), *rate_Hz);
      of_record[column.name] = CurveJson({std::move(spectrum.frequency_Hz), std::move(spectrum.amplitude)},
                                         "frequency_Hz", "amplitude_m_per_s2");
    }
    if (!of_record.empty()) spectra = std::move(of_record);
  }
  return spectra.empty() ? json() : spectra;
}

}  // namespace

PlotCurve Thinned(const PlotCurve& curve, std::size_t most) {
  const std::size_t points = curve.y.size();
  if (points <= most) return curve;
  const std::size_t bins = std::max<std::size_t>(1, most / 2);
  PlotCurve thinned;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const auto begin = curve.y.begin() + static_cast<std::ptrdiff_t>(bin * points / bins);
    const auto end = curve.y.begin() + static_cast<std::ptrdiff_t>((bin + 1) * points / bins);
    const auto [low, high] = std::minmax_element(begin, end);
    for (const auto at : {std::min(low, high), std::max(low, high)}) {
      thinned.x.push_back(curve.x[static_cast<std::size_t>(at - curve.y.begin())]);
      thinned.y.push_back(*at);
      if (low == high) break;
    }
  }
  return thinned;
}

json MeasurementsJson(int cycle, const CycleCurves& curves) {
  json error;
  if (const auto& measured = curves.analysis.transmission_error) {
    error = {{"cw", TurnJson(measured->cw)}, {"ccw", TurnJson(measured->ccw)}};
  }
  return {{"cycle", cycle},
          {"hysteresis", LoopJson(curves)},
          {"transmission_error", std::move(error)},
          {"spectrum", SpectrumJson(curves.records)}};
}

json ReadMeasurements(const CampaignFolder& folder, int cycle) {
  const Journal journal = Journal::OpenAsRead(folder.Journal());
  const int newest = std::max(0, journal.LastCompleteCycle());
  if (cycle < 0 || cycle > newest) {
    throw std::invalid_argument(
        fmt::format("cycle = {} is not complete (expected 1 to {}, or 0 for the newest)", cycle, newest));
  }
  if (newest == 0) return MeasurementsJson(0, {});
  const CampaignInputs inputs = ReadFrozenInputs(folder, journal);
  const int read = cycle == 0 ? newest : cycle;
  return MeasurementsJson(
      read, ReadCycleCurves(folder, journal, read, ContextOf(journal, inputs.schedule, inputs.bench)));
}

}  // namespace strainwave::bench
