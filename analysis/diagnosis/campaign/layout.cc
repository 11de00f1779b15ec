// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/campaign/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "analysis/arguments.h"
#include "analysis/decompositions.h"
#include "analysis/diagnosis/campaign/noise.h"
#include "analysis/quantities.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

SeriesName Split(const std::string& full) {
  const QuantityUnit* const unit = FindUnit(full);
  if (unit == nullptr) return {full, full, "", "1"};
  return {full, std::string(WithoutUnit(full)), std::string(unit->in_names), std::string(unit->symbol)};
}

void RequireAscending(std::string_view name, std::span<const double> values) {
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] < values[i - 1]) {
      throw std::invalid_argument(fmt::format("{}[{}] = {} is less than {} before it (expected not to fall)",
                                              name, i, values[i], values[i - 1]));
    }
  }
}

void Check(const CampaignData& campaign) {
  RequireFinite("cycle", campaign.cycle);
  RequireFinite("time_s", campaign.time_s);
  RequireFinite("load_time_s", campaign.load_time_s);
  if (!campaign.time_s.empty()) RequireSameLength("time_s", campaign.time_s, "cycle", campaign.cycle);
  if (!campaign.load_time_s.empty()) {
    RequireSameLength("load_time_s", campaign.load_time_s, "cycle", campaign.cycle);
  }
  if (!campaign.temperature_degC.empty()) {
    RequireSameLength("temperature_degC", campaign.temperature_degC, "cycle", campaign.cycle);
  }
  for (const CampaignSeries& series : campaign.series) {
    RequireSameLength(series.name, series.value, "cycle", campaign.cycle);
    if (!series.standard_error.empty()) {
      RequireSameLength(series.name + " (standard error)", series.standard_error, "cycle", campaign.cycle);
    }
  }
  if (!campaign.sensor_serials.empty() && campaign.sensor_serials.size() != campaign.cycle.size()) {
    throw std::invalid_argument(
        fmt::format("sensor_serials has {} values, cycle has {} (expected the same number)",
                    campaign.sensor_serials.size(), campaign.cycle.size()));
  }
  RequireAscending("cycle", campaign.cycle);
  RequireAscending("time_s", campaign.time_s);
  RequireAscending("load_time_s", campaign.load_time_s);
  if (campaign.cycle.size() < kFewestCycles) {
    throw std::invalid_argument(fmt::format("the campaign has {} cycles with results (expected at least {})",
                                            campaign.cycle.size(), kFewestCycles));
  }
}

bool AllFinite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

double Interpolate(const std::vector<double>& values, double row) {
  const double last = static_cast<double>(values.size() - 1);
  const double at = std::clamp(row, 0.0, last);
  const auto below = std::min(static_cast<std::size_t>(at), values.size() - 2);
  const double share = at - static_cast<double>(below);
  return values[below] + share * (values[below + 1] - values[below]);
}

// Series with enough values that differ, NaN where a cycle has none.
std::vector<std::vector<double>> UsableSeries(const CampaignData& campaign, CampaignLayout& layout,
                                              std::vector<double>& standard_errors) {
  std::vector<std::vector<double>> values;
  for (const CampaignSeries& series : campaign.series) {
    std::vector<double> finite;
    for (const double value : series.value) {
      if (std::isfinite(value)) finite.push_back(value);
    }
    if (finite.size() < kFewestCycles) {
      if (!finite.empty()) {
        layout.warnings.push_back(
            fmt::format("{} has a value in {} cycles only and is left out (expected {})", series.name,
                        finite.size(), kFewestCycles));
      }
      continue;
    }
    const auto [low, high] = std::minmax_element(finite.begin(), finite.end());
    if (*low == *high) {
      layout.warnings.push_back(fmt::format("{} is {} in all cycles and is left out", series.name, *low));
      continue;
    }
    layout.series.push_back(Split(series.name));
    standard_errors.push_back(MedianError(series.standard_error));
    values.push_back(series.value);
  }
  if (values.empty()) {
    throw std::invalid_argument(fmt::format(
        "no result of the campaign has a value in {} cycles or more (expected at least one series)",
        kFewestCycles));
  }
  return values;
}

// Response and mixing, series after series.
void Stack(const std::vector<std::vector<double>>& values, const Eigen::MatrixXd& correlation,
           CampaignLayout& layout) {
  const std::size_t count = values.size();
  const std::size_t cycles = layout.cycles();
  // The mixing of a cycle is the inverse Cholesky factor of what is there in that cycle.
  std::vector<Eigen::MatrixXd> mixing_of(cycles);
  for (std::size_t c = 0; c < cycles; ++c) {
    std::vector<Index> there;
    for (std::size_t s = 0; s < count; ++s) {
      if (std::isfinite(values[s][c])) there.push_back(static_cast<Index>(s));
    }
    const auto size = static_cast<Index>(there.size());
    mixing_of[c] = Eigen::MatrixXd::Zero(static_cast<Index>(count), static_cast<Index>(count));
    if (size == 0) continue;
    const Eigen::MatrixXd part = correlation(there, there);
    mixing_of[c](there, there) = InverseCholesky(part);
  }
  std::vector<Eigen::VectorXd> rows;
  for (std::size_t s = 0; s < count; ++s) {
    layout.segments.push_back(layout.measured.size());
    for (std::size_t c = 0; c < cycles; ++c) {
      if (!std::isfinite(values[s][c])) continue;
      const Eigen::VectorXd row = mixing_of[c].row(static_cast<Index>(s));
      double sum = 0.0;
      for (std::size_t k = 0; k < count; ++k) {
        const double weight = row(static_cast<Index>(k));
        if (weight != 0.0) sum += weight * values[k][c] / layout.scale[k];
      }
      layout.measured.push_back(sum);
      layout.cycle_of.push_back(c);
      layout.mixed_of.push_back(s);
      rows.push_back(row);
    }
  }
  layout.mixing.resize(static_cast<Index>(rows.size()), static_cast<Index>(count));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    layout.mixing.row(static_cast<Index>(i)) = rows[i].transpose();
  }
}

}  // namespace

std::string SeriesName::Parameter(const std::string& what, const std::string& per) const {
  return fmt::format("{}{}{}{}{}", what, what.empty() ? "" : "_", full, per.empty() ? "" : "_", per);
}

double CampaignLayout::CycleAtRow(double row) const { return Interpolate(cycle, row); }
double CampaignLayout::LoadShareAt(double row) const { return Interpolate(load_share, row); }

double CampaignLayout::RowOfCycle(double number) const {
  const auto above = std::upper_bound(cycle.begin() + 1, cycle.end() - 1, number);
  const auto row = static_cast<double>(above - cycle.begin());
  const double span = *above - *(above - 1);
  return span > 0.0 ? row - (*above - number) / span : row;
}

Eigen::MatrixXd WearColumns(const std::vector<double>& load_share, double run_in_share) {
  const Eigen::Map<const Eigen::ArrayXd> u(load_share.data(), static_cast<Index>(load_share.size()));
  Eigen::MatrixXd columns(u.size(), 4);
  columns.col(0).setOnes();
  columns.col(1) = u;
  columns.col(2) = u.cube();
  columns.col(3) = (-u / run_in_share).exp();
  return columns;
}

CampaignLayout LayOut(const CampaignData& campaign) {
  Check(campaign);
  CampaignLayout layout;
  layout.cycle = campaign.cycle;
  layout.time_s = campaign.time_s;
  // Without credited load time the cycle stands for it; one hour each, as every number needs a unit.
  layout.load_time_s = campaign.load_time_s;
  if (layout.load_time_s.empty()) {
    for (const double cycle : campaign.cycle) layout.load_time_s.push_back(3600.0 * cycle);
    layout.warnings.emplace_back("no credited load time: every cycle counts as one hour of it");
  }
  if (AllFinite(campaign.temperature_degC)) layout.temperature_degC = campaign.temperature_degC;
  layout.sensor_serials = campaign.sensor_serials;
  layout.load_span_s = layout.load_time_s.back() - layout.load_time_s.front();
  if (!(layout.load_span_s > 0.0)) {
    throw std::invalid_argument(fmt::format("load_time_s is {} in all {} cycles (expected to grow)",
                                            layout.load_time_s.front(), layout.cycles()));
  }
  for (const double time_s : layout.load_time_s) {
    layout.load_share.push_back((time_s - layout.load_time_s.front()) / layout.load_span_s);
  }
  std::vector<double> standard_errors;
  const std::vector<std::vector<double>> values = UsableSeries(campaign, layout, standard_errors);
  const CampaignNoise noise = EstimateCampaignNoise(values, standard_errors, layout);
  layout.scale = noise.scale;
  layout.noise_floor = noise.floor;
  layout.run_in_share = noise.run_in_share;
  layout.single_tail = noise.single_tail;
  for (std::size_t s = 0; s < values.size(); ++s) {
    const double ratio = standard_errors[s] > 0.0 ? noise.scatter[s] / standard_errors[s] : 1.0;
    if (ratio > 2.0) {
      layout.warnings.push_back(
          fmt::format("{} scatters {:.1f} times as much from cycle to cycle as its standard errors say",
                      layout.series[s].full, ratio));
    }
  }
  Stack(values, noise.correlation, layout);
  return layout;
}

}  // namespace strainwave::analysis::diagnosis
