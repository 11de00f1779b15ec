// SPDX-License-Identifier: Apache-2.0
#include "bench/report/load_history.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <span>
#include <variant>

#include "analysis/rainflow.h"
#include "analysis/units.h"
#include "bench/campaign/life_share.h"
#include "daq/cycle_file.h"
#include "schedules/reader/plan.h"

namespace strainwave::bench {
namespace {

constexpr double kCube = 3.0;  // of the bearing's life law (docs/effects.md#bearing-life)
constexpr double kClasses_to_the_limit = 10.0;
constexpr std::string_view kTorques[] = {"torque_min_Nm", "torque_max_Nm", "torque_Nm", "output_torque_Nm"};

// 1, 2 or 5 times a power of ten.
double RoundWidth(double wanted) {
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double digit : {5.0, 2.0}) {
    if (digit * power <= wanted) return digit * power;
  }
  return power;
}

// Takes a history piece by piece.
class SpectrumCounter {
 public:
  explicit SpectrumCounter(const schedules::Schedule& schedule)
      : rated_range_Nm_(2.0 * schedule.specimen.rated_torque_Nm) {
    spectrum_.width_Nm = RoundWidth(schedule.limits.output_torque_Nm / kClasses_to_the_limit);
  }

  void Take(std::span<const double> torque_Nm) {
    open_Nm_.insert(open_Nm_.end(), torque_Nm.begin(), torque_Nm.end());
    analysis::RainflowPart part = analysis::CountRainflowPart(open_Nm_);
    Count(part.closed);
    open_Nm_ = std::move(part.open);
  }

  LoadSpectrum End() {
    Count(analysis::CountRainflow(open_Nm_));
    return std::move(spectrum_);
  }

 private:
  void Count(std::span<const analysis::RainflowRange> ranges) {
    for (const analysis::RainflowRange& counted : ranges) {
      const auto at = static_cast<std::size_t>(counted.range / spectrum_.width_Nm);
      if (at >= spectrum_.classes.size()) spectrum_.classes.resize(at + 1);
      LoadSpectrum::Class& one = spectrum_.classes[at];
      one.cycles += counted.cycles;
      one.mean_sum_Nm += counted.cycles * counted.mean;
      one.reversals += analysis::EquivalentCycles({&counted, 1}, rated_range_Nm_, kCube);
      spectrum_.largest_Nm = std::max(spectrum_.largest_Nm, counted.range);
    }
  }

  double rated_range_Nm_;
  LoadSpectrum spectrum_;
  std::vector<double> open_Nm_;
};

void AppendFinite(double torque_Nm, std::vector<double>& torques_Nm) {
  if (std::isfinite(torque_Nm)) torques_Nm.push_back(torque_Nm);
}

// Of a row its smallest and its largest are known, not which came first: the one that is nearer to what was
// before.
void AppendRows(std::span<const double> min_Nm, std::span<const double> max_Nm,
                std::vector<double>& torques_Nm) {
  for (std::size_t i = 0; i < min_Nm.size(); ++i) {
    const double before_Nm = torques_Nm.back();
    const bool min_first = std::abs(min_Nm[i] - before_Nm) <= std::abs(max_Nm[i] - before_Nm);
    AppendFinite(min_first ? min_Nm[i] : max_Nm[i], torques_Nm);
    AppendFinite(min_first ? max_Nm[i] : min_Nm[i], torques_Nm);
  }
}

// Output torque of one record; nothing of one that has none.
void AppendRecord(const daq::Record& record, std::vector<double>& torques_Nm) {
  const std::size_t before = torques_Nm.size();
  torques_Nm.push_back(0.0);
  if (record.FindColumn("torque_min_Nm") != nullptr && record.FindColumn("torque_max_Nm") != nullptr) {
    AppendRows(record.CopyAsDoubles("torque_min_Nm"), record.CopyAsDoubles("torque_max_Nm"), torques_Nm);
  } else if (record.FindColumn("output_torque_Nm") != nullptr) {
    for (const double torque_Nm : record.CopyAsDoubles("output_torque_Nm"))
      AppendFinite(torque_Nm, torques_Nm);
  } else if (record.kind == daq::RecordKind::kHysteresis && record.FindColumn("torque_Nm") != nullptr) {
    for (const double torque_Nm : record.CopyAsDoubles("torque_Nm")) AppendFinite(torque_Nm, torques_Nm);
  }
  torques_Nm.size() == before + 1 ? torques_Nm.pop_back() : torques_Nm.push_back(0.0);
}

// "/repeat/2/hysteresis/hysteresis_1" is of the phase "hysteresis".
bool IsOfPhase(std::string_view group, const std::set<std::string>& phases) {
  return std::ranges::any_of(phases, [&](const std::string& phase) {
    return group.starts_with("/" + phase + "/") || group.find("/" + phase + "/") != std::string_view::npos;
  });
}

std::set<std::string> BlankTests(const schedules::Schedule& schedule) {
  std::set<std::string> names;
  for (const schedules::Phase& phase : schedule.preparation) {
    if (std::holds_alternative<schedules::BlankTest>(phase.parameters)) names.insert(phase.name);
  }
  return names;
}

void AppendPlanned(const schedules::Phase& phase, double ratio, std::vector<double>& torques_Nm) {
  if (const auto* const run = std::get_if<schedules::LoadRun>(&phase.parameters)) {
    const double way_s =
        schedules::MoveTime_s(run->turns * kTwoPi * std::abs(ratio), run->input_speed_rad_per_s,
                              run->input_acceleration_rad_per_s2);
    const auto ways = static_cast<int>(std::ceil(run->duration_s / way_s));
    // Clockwise first, which the load brakes with negative torque.
    for (int way = 0; way < ways; ++way)
      torques_Nm.push_back(way % 2 == 0 ? -run->output_torque_Nm : run->output_torque_Nm);
    torques_Nm.push_back(0.0);
  } else if (const auto* const rotation = std::get_if<schedules::MeasurementRotation>(&phase.parameters)) {
    torques_Nm.push_back(rotation->clockwise ? -rotation->output_torque_Nm : rotation->output_torque_Nm);
    torques_Nm.push_back(0.0);
  } else if (const auto* const test = std::get_if<schedules::HysteresisTest>(&phase.parameters)) {
    const double peak_Nm = test->peak_torque_Nm;
    const auto loops = static_cast<double>(test->lock_angles_rad.size()) * std::ceil(test->loops);
    for (double loop = 0.0; loop < loops; loop += 1.0)
      torques_Nm.insert(torques_Nm.end(), {peak_Nm, -peak_Nm, peak_Nm, 0.0});
  }
}

LoadSpectrum PlannedSpectrum(const schedules::Schedule& schedule, const std::vector<int>& cycles) {
  SpectrumCounter counter(schedule);
  const double ratio = schedule.specimen.ratio;
  std::vector<double> preparation_Nm{0.0};
  for (const schedules::Phase& phase : schedule.preparation) AppendPlanned(phase, ratio, preparation_Nm);
  for (int repeat = 0; repeat < schedule.measurements.repeatability_repeats; ++repeat) {
    for (const schedules::Phase& phase : schedule.phases) {
      if (!std::holds_alternative<schedules::LoadRun>(phase.parameters))
        AppendPlanned(phase, ratio, preparation_Nm);
    }
  }
  std::vector<double> cycle_Nm{0.0};
  for (const schedules::Phase& phase : schedule.phases) AppendPlanned(phase, ratio, cycle_Nm);
  for (const int cycle : cycles) counter.Take(cycle == 0 ? preparation_Nm : cycle_Nm);
  return counter.End();
}

LoadRunShare ShareOf(const schedules::Phase& phase, const schedules::Specimen& specimen, int runs,
                     const std::map<std::string, std::pair<double, int>>& equivalent_s) {
  const auto& run = std::get<schedules::LoadRun>(phase.parameters);
  const double turn_rad = run.turns * kTwoPi * std::abs(specimen.ratio);
  const double mean_rad_per_s = turn_rad / schedules::MoveTime_s(turn_rad, run.input_speed_rad_per_s,
                                                                 run.input_acceleration_rad_per_s2);
  LoadRunShare share{phase.name, 0.0, 0.0, runs, 0};
  share.planned = runs * LifeShare(specimen, {{run.output_torque_Nm, mean_rad_per_s, run.duration_s}});
  if (const auto found = equivalent_s.find(phase.name); found != equivalent_s.end()) {
    const auto& [sum_s, count] = found->second;
    share.measured = LifeShare(specimen, {{run.output_torque_Nm, run.input_speed_rad_per_s, sum_s}});
    share.runs_measured = count;
  }
  return share;
}

}  // namespace

double LoadSpectrum::cycles() const {
  return std::accumulate(classes.begin(), classes.end(), 0.0,
                         [](double sum, const Class& one) { return sum + one.cycles; });
}

double LoadSpectrum::reversals() const {
  return std::accumulate(classes.begin(), classes.end(), 0.0,
                         [](double sum, const Class& one) { return sum + one.reversals; });
}

LoadHistory ReadLoadHistory(const CampaignFolder& folder, const CampaignIntegrity& integrity,
                            const schedules::Schedule& schedule, const std::vector<int>& cycles) {
  std::set<std::string> whole;
  for (const FileIntegrity& file : integrity.files) {
    if (file.state == FileState::kWhole) whole.insert(file.path);
  }
  const std::set<std::string> blank_tests = BlankTests(schedule);
  LoadHistory history;
  SpectrumCounter counter(schedule);
  for (const int cycle : cycles) {
    const std::filesystem::path file = folder.CycleFile(cycle);
    std::vector<double> torques_Nm;
    if (whole.contains(file.lexically_relative(folder.root).generic_string())) {
      for (const daq::NamedRecord& named : daq::ReadCycleFile(file, daq::Checking::kNone, kTorques).records) {
        if (!IsOfPhase(named.group, blank_tests)) AppendRecord(named.record, torques_Nm);
      }
    }
    if (torques_Nm.empty()) {
      if (cycle > 0) history.cycles_missing.push_back(cycle);
      continue;
    }
    ++history.cycles_read;
    counter.Take(torques_Nm);
  }
  history.ran = counter.End();
  history.planned = PlannedSpectrum(schedule, cycles);
  return history;
}

std::vector<LoadRunShare> LoadRunShares(const schedules::Schedule& schedule, int complete,
                                        const std::map<std::string, std::pair<double, int>>& equivalent_s) {
  std::vector<LoadRunShare> shares;
  const auto take = [&](const std::vector<schedules::Phase>& phases, int runs) {
    for (const schedules::Phase& phase : phases) {
      if (std::holds_alternative<schedules::LoadRun>(phase.parameters))
        shares.push_back(ShareOf(phase, schedule.specimen, runs, equivalent_s));
    }
  };
  take(schedule.preparation, 1);
  take(schedule.phases, complete);
  return shares;
}

}  // namespace strainwave::bench
