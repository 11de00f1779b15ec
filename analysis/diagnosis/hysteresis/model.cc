// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {

using Eigen::Index;

LoopModel::LoopModel(const LoopRecords& records, std::vector<const LoopEffect*> effects)
    : records_(records), effects_(std::move(effects)) {
  constexpr double kStep = 1e-6;
  // A spring of half the record's mean compliance or ten times it is no gear's any more.
  const double ln_k = -std::log(records.compliance_rad_per_Nm());
  const double spread = std::log(12.0);
  for (int k = 0; k < 3; ++k) numbers_.push_back({ln_k - spread, ln_k + spread, kStep, false, false});
  numbers_[kLnK3].held = records.peak_torque_Nm < kReachesThird * records.t2_Nm;
  numbers_.push_back(
      {std::log(1e-4 * records.t1_Nm), std::log(0.7 * records.peak_torque_Nm), kStep, false, false});
  const double ln_range = std::log(ArcminFromRad(records.twist_range_rad));
  numbers_.push_back({ln_range + std::log(1e-3), ln_range + std::log(0.4), kStep, false, false});
  for (std::size_t r = 0; r < records.samples.records(); ++r) {
    const double range_arcmin = ArcminFromRad(records.twist_range_rad);
    numbers_.push_back({-2.0 * range_arcmin, 2.0 * range_arcmin, kStep, false, false});
    numbers_.push_back({-1.0, 1.0, kStep, false, false, static_cast<int>(r)});
  }
  nominal_size_ = size();
  for (const LoopEffect* effect : effects_) {
    first_of_effect_.push_back(size());
    numbers_.insert(numbers_.end(), effect->numbers.begin(), effect->numbers.end());
  }
}

bool LoopModel::NeedsAllSamples() const {
  return std::any_of(effects_.begin(), effects_.end(),
                     [](const LoopEffect* e) { return e->needs_all_samples; });
}

std::span<const double> LoopModel::Of(std::size_t effect, const Eigen::VectorXd& x) const {
  return {x.data() + first_of_effect_[effect], effects_[effect]->numbers.size()};
}

std::span<double> LoopModel::Of(std::size_t effect, Eigen::VectorXd& x) const {
  return {x.data() + first_of_effect_[effect], effects_[effect]->numbers.size()};
}

std::vector<bool> LoopModel::Held(const Eigen::VectorXd& x) const {
  std::vector<bool> held(numbers_.size());
  for (std::size_t k = 0; k < static_cast<std::size_t>(nominal_size_); ++k) held[k] = numbers_[k].held;
  for (std::size_t e = 0; e < effects_.size(); ++e) {
    for (std::size_t k = 0; k < effects_[e]->numbers.size(); ++k) {
      held[static_cast<std::size_t>(first_of_effect_[e]) + k] = effects_[e]->IsHeld(Of(e, x), k);
    }
  }
  for (std::size_t k = 0; k < held.size() && !kept_starts_.empty(); ++k) {
    const int record = numbers_[k].state_of_record;
    if (record >= 0) held[k] = held[k] || kept_starts_[static_cast<std::size_t>(record)];
  }
  for (const int number : held_) held[static_cast<std::size_t>(number)] = true;
  return held;
}

int LoopModel::FreeParameters(const Eigen::VectorXd& x) const {
  const std::vector<bool> held = Held(x);
  auto free = static_cast<int>(std::count(held.begin(), held.begin() + nominal_size_, false));
  for (std::size_t e = 0; e < effects_.size(); ++e) {
    const auto first = held.begin() + first_of_effect_[e];
    const auto own = static_cast<int>(
        std::count(first, first + static_cast<std::ptrdiff_t>(effects_[e]->numbers.size()), false));
    // A location that was searched for counts though no step moves it.
    free += std::max(own, effects_[e]->rule.degrees_of_freedom);
  }
  return free;
}

double LoopModel::LogSearchLocations(const Eigen::VectorXd& x) const {
  double sum = 0.0;
  for (std::size_t e = 0; e < effects_.size(); ++e) sum += effects_[e]->LogSearchLocations(Of(e, x));
  return sum;
}

GearLaw LoopModel::LawOf(const Eigen::VectorXd& x) const {
  GearLaw law;
  law.spring = {std::exp(x[kLnK1]), std::exp(x[kLnK2]), std::exp(x[numbers_[kLnK3].held ? kLnK2 : kLnK3]),
                records_.t1_Nm, records_.t2_Nm};
  law.friction[0] = {std::exp(x[kLnFriction]), RadFromArcmin(std::exp(x[kLnYield]))};
  law.start_share.resize(records_.samples.records());
  for (std::size_t r = 0; r < law.start_share.size(); ++r) {
    law.start_share[r][0] = x[kFirstOfRecord + kNumbersOfRecord * static_cast<int>(r) + 1];
  }
  for (std::size_t e = 0; e < effects_.size(); ++e) {
    if (effects_[e]->shapes_gear) effects_[e]->ShapeGear(Of(e, x), law);
  }
  return law;
}

void LoopModel::AddOffsets(const Eigen::VectorXd& x, const LoopGrid& grid, Eigen::VectorXd& total) const {
  for (std::size_t r = 0; r < grid.records(); ++r) {
    const auto first = static_cast<Index>(grid.starts[r]);
    const auto count = static_cast<Index>(grid.starts[r + 1]) - first;
    total.segment(first, count).array() +=
        RadFromArcmin(x[kFirstOfRecord + kNumbersOfRecord * static_cast<int>(r)]);
  }
}

void LoopModel::AddEffects(const Eigen::VectorXd& x, const LoopGrid& grid, const Eigen::VectorXd& gear,
                           bool followers, Eigen::VectorXd& total) const {
  for (std::size_t e = 0; e < effects_.size(); ++e) {
    if (!effects_[e]->shapes_gear && effects_[e]->follows_gear == followers) {
      effects_[e]->Add(Of(e, x), grid, gear, total);
    }
  }
}

Eigen::VectorXd LoopModel::Predict(const Eigen::VectorXd& x, const LoopGrid& grid) const {
  Eigen::VectorXd gear;
  FillTwist(LawOf(x), grid, gear);
  Eigen::VectorXd total = gear;
  AddOffsets(x, grid, total);
  AddEffects(x, grid, gear, true, total);
  AddEffects(x, grid, gear, false, total);
  return total;
}

Eigen::VectorXd LoopModel::Predict(const Eigen::VectorXd& x, const LoopGrid& grid,
                                   Eigen::MatrixXd& derivatives) const {
  const auto n = static_cast<Index>(grid.size());
  derivatives.setZero(n, size());
  const std::vector<bool> held = Held(x);
  Eigen::VectorXd gear;
  FillTwist(LawOf(x), grid, gear);
  std::vector<Eigen::VectorXd> added;  // by each effect
  // What goes with the gear's twist, what does not.
  Eigen::VectorXd moving = gear;
  Eigen::VectorXd beside = Eigen::VectorXd::Zero(n);
  for (std::size_t e = 0; e < effects_.size(); ++e) {
    Eigen::VectorXd& own = added.emplace_back(Eigen::VectorXd::Zero(n));
    if (effects_[e]->shapes_gear) continue;
    effects_[e]->Add(Of(e, x), grid, gear, own);
    (effects_[e]->follows_gear ? moving : beside) += own;
  }
  Eigen::VectorXd total = moving + beside;
  AddOffsets(x, grid, total);

  Eigen::VectorXd moved_gear;
  Eigen::VectorXd moved;
  const auto step_of = [&](int k) {
    const FitNumber& number = numbers_[static_cast<std::size_t>(k)];
    return x[k] + number.step > number.high ? -number.step : number.step;
  };
  const auto by_gear = [&](int k) {
    Eigen::VectorXd there = x;
    there[k] += step_of(k);
    FillTwist(LawOf(there), grid, moved_gear);
    moved = moved_gear;
    AddEffects(there, grid, moved_gear, true, moved);
    derivatives.col(k) = (moved - moving) / (there[k] - x[k]);
  };
  for (int k = 0; k < nominal_size_; ++k) {
    if (held[static_cast<std::size_t>(k)]) continue;
    const int of_record = k - kFirstOfRecord;
    if (of_record >= 0 && of_record % kNumbersOfRecord == 0) {
      const auto record = static_cast<std::size_t>(of_record / kNumbersOfRecord);
      const auto first = static_cast<Index>(grid.starts[record]);
      derivatives.col(k)
          .segment(first, static_cast<Index>(grid.starts[record + 1]) - first)
          .setConstant(RadFromArcmin(1.0));
    } else {
      by_gear(k);
    }
  }
  for (std::size_t e = 0; e < effects_.size(); ++e) {
    for (std::size_t j = 0; j < effects_[e]->numbers.size(); ++j) {
      const int k = first_of_effect_[e] + static_cast<int>(j);
      if (held[static_cast<std::size_t>(k)]) continue;
      if (effects_[e]->shapes_gear) {
        by_gear(k);
        continue;
      }
      Eigen::VectorXd there = x;
      there[k] += step_of(k);
      moved.setZero(n);
      effects_[e]->Add(Of(e, there), grid, gear, moved);
      derivatives.col(k) = (moved - added[e]) / (there[k] - x[k]);
    }
  }
  return total;
}

std::vector<int> LoopModel::Amounts(const Eigen::VectorXd& x, std::size_t effect) const {
  std::vector<int> amounts;
  for (std::size_t k = 0; k < effects_[effect]->numbers.size(); ++k) {
    if (effects_[effect]->numbers[k].amount && !effects_[effect]->IsHeld(Of(effect, x), k)) {
      amounts.push_back(first_of_effect_[effect] + static_cast<int>(k));
    }
  }
  return amounts;
}

Eigen::MatrixXd LoopModel::AmountColumns(const Eigen::VectorXd& x, const LoopGrid& grid, std::size_t effect,
                                         const Eigen::VectorXd& gear_rad) const {
  // A wider step than for derivatives: what a dead zone or an element does at a size that could be seen.
  constexpr double kWider = 1e3;
  const auto n = static_cast<Index>(grid.size());
  const LoopEffect& asked = *effects_[effect];
  const auto with = [&](const Eigen::VectorXd& numbers) -> Eigen::VectorXd {
    if (asked.shapes_gear) return Predict(numbers, grid);
    Eigen::VectorXd added = Eigen::VectorXd::Zero(n);
    asked.Add(Of(effect, numbers), grid, gear_rad, added);
    return added;
  };
  const std::vector<int> amounts = Amounts(x, effect);
  Eigen::MatrixXd columns(n, static_cast<Index>(amounts.size()));
  const Eigen::VectorXd here = with(x);
  for (std::size_t j = 0; j < amounts.size(); ++j) {
    const double step = kWider * numbers_[static_cast<std::size_t>(amounts[j])].step;
    Eigen::VectorXd there = x;
    there[amounts[j]] += step;
    columns.col(static_cast<Index>(j)) = (with(there) - here) / step;
  }
  return columns;
}

std::vector<ParameterValue> DescribeEffect(const LoopModel& model, std::size_t effect,
                                           const Eigen::VectorXd& numbers,
                                           const Eigen::MatrixXd& covariance) {
  const std::span<const double> own = model.Of(effect, numbers);
  const auto first = static_cast<Eigen::Index>(own.data() - numbers.data());
  const auto count = static_cast<Eigen::Index>(own.size());
  return model.effects()[effect]->Describe(own, covariance.block(first, first, count, count));
}

}  // namespace strainwave::analysis::diagnosis
