// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/detection_power.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "analysis/diagnosis/cause_sets.h"
#include "analysis/diagnosis/planted_records.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kTrialsAtATime = 4;  // trials of a cause, before their sizes are chosen anew
constexpr std::size_t kFewestTrials = 12;
constexpr std::size_t kMostTrials = 28;
constexpr double kNarrow = 0.5;  // of ln size: an interval of 1 : 1.65
constexpr std::size_t kWithoutEffect = 20;
constexpr std::size_t kSizing = 9;        // draws from which the first size is taken
constexpr double kExpectedSigma = 6.0;    // about where searches of this sort find what they look for
constexpr double kLargest = 40.0;         // times that: beyond it nothing is found that was not before
constexpr double kNoNoise = 1e-10;        // of the response: what rounding of numbers leaves of nothing
constexpr std::size_t kEnoughMisses = 8;  // at the largest sizes, and none found: it never will be

std::uint64_t Mixed(std::uint64_t seed, std::uint64_t cause, std::uint64_t trial) {
  // SplitMix64's last steps, so that neighbours have nothing in common.
  std::uint64_t z = seed + 0x9e3779b97f4a7c15ULL * (1 + trial + (cause << 32U));
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

double LargestOf(std::span<const double> values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

// One cause on its way to its size.
struct Growing {
  CausePower power;
  const CauseRule* rule{};
  PlantingBase base;
  double ln_expected{};
  double ln_most{};
  std::vector<std::string> objections;  // one a trial
  bool settled{};

  std::vector<PlantedTrial> TrialsBy(double PlantedOutcome::*size) const {
    std::vector<PlantedTrial> trials;
    for (const PlantedOutcome& outcome : power.trials)
      if (outcome.*size > 0.0) trials.push_back({std::log(outcome.*size), outcome.found});
    return trials;
  }
  bool IsLarge(const PlantedOutcome& outcome) const {
    return std::log(outcome.amount) > ln_most - std::log(4.0);
  }
  bool NeverFound() const {
    const auto large = std::ranges::count_if(power.trials, [&](const auto& one) { return IsLarge(one); });
    const bool none =
        std::ranges::none_of(power.trials, [&](const auto& one) { return IsLarge(one) && one.found; });
    return none && static_cast<std::size_t>(large) >= kEnoughMisses;
  }
  void Settle() {
    const std::size_t made = power.trials.size();
    if (made >= kMostTrials || NeverFound()) {
      settled = true;
    } else if (made >= kFewestTrials) {
      const DetectableSize now = EstimateDetectableSize(TrialsBy(&PlantedOutcome::amount));
      settled = now.reached && now.ln_high - now.ln_low < kNarrow;
    }
  }
  void Conclude() {
    const auto estimate = [&](double PlantedOutcome::*size) -> std::optional<DetectedFrom> {
      const std::vector<PlantedTrial> trials = TrialsBy(size);
      if (trials.empty()) return std::nullopt;
      const DetectableSize known = EstimateDetectableSize(trials);
      if (!known.reached) return std::nullopt;
      return DetectedFrom{std::exp(known.ln_size), std::exp(known.ln_low), std::exp(known.ln_high)};
    };
    if (!NeverFound()) power.size = estimate(&PlantedOutcome::amount);
    if (power.size)
      power.sigma = estimate(&PlantedOutcome::sigma);
    else if (power.objection.empty())
      power.objection = WhyNever();
  }
  // Of the largest that was missed: the name given in its place, or what the search held against it.
  std::string WhyNever() const {
    std::map<std::string, int> instead;
    std::size_t missed = 0;
    const PlantedOutcome* largest = nullptr;
    std::string objection;
    for (std::size_t i = 0; i < power.trials.size(); ++i) {
      const PlantedOutcome& outcome = power.trials[i];
      if (outcome.found || !IsLarge(outcome)) continue;
      ++missed;
      for (const std::string& name : outcome.others) ++instead[name];
      if (largest != nullptr && outcome.amount < largest->amount) continue;
      largest = &outcome;
      objection = objections[i];
    }
    for (const auto& [name, times] : instead) {
      if (2 * static_cast<std::size_t>(times) > missed)
        return fmt::format("{} of {} were called {}", times, missed, name);
    }
    return objection;
  }
};

// Causes that can be planted, each form that has an amount of its own once.
std::vector<Growing> PlantableCauses(const Study& study, const Diagnosis& diagnosis,
                                     const DiagnoseOptions& options, DetectionPower& power) {
  std::vector<Growing> all;
  for (std::size_t cause = 0; cause < study.causes().size(); ++cause) {
    const CauseRule& rule = study.causes()[cause];
    if (!rule.named || Contains(options.given_causes, cause)) continue;
    const auto effect = study.DrawEffect(cause, diagnosis.extended, Mixed(options.seed, cause, 0));
    if (!effect) {
      power.cannot_be_drawn.push_back(rule.name);
      continue;
    }
    const auto same = std::ranges::find_if(all, [&](const Growing& other) {
      return other.rule->name == rule.name && other.power.amount == effect->amount;
    });
    if (same != all.end() && same->rule->degrees_of_freedom <= rule.degrees_of_freedom) continue;
    Growing& own = same != all.end() ? *same : all.emplace_back();
    own.power.cause = cause;
    own.power.amount = effect->amount;
    own.power.unit = effect->unit;
    own.rule = &rule;
  }
  std::erase_if(power.cannot_be_drawn, [&](const std::string& name) {
    return std::ranges::any_of(all, [&](const Growing& other) { return other.rule->name == name; });
  });
  std::ranges::sort(all, {}, [](const Growing& own) { return own.power.cause; });
  return all;
}

// Where the first trials of a cause lie, and the last.
void FindSizes(const Study& study, const Diagnosis& diagnosis, const PlantedRecords& planting,
               const DiagnoseOptions& options, Growing& own) {
  own.base = planting.BaseWithout(own.rule->name);
  double largest = kUnlimited;
  double expected = 0.0;
  for (const double share : {1e-3, 1.0}) {  // the second time at the size that the first one tells
    std::vector<double> each;
    for (std::size_t k = 0; k < kSizing; ++k) {
      const auto effect =
          study.DrawEffect(own.power.cause, diagnosis.extended, Mixed(options.seed, own.power.cause, k));
      if (!effect) continue;
      largest = std::min(largest, effect->largest_amount);
      const double tried = expected > 0.0                 ? share * std::min(expected, largest)
                           : effect->largest_amount < 1e6 ? share * effect->largest_amount
                                                          : share;
      const double sigma = planting.SigmaOf(own.base, effect->added(tried));
      const double whole = planting.SigmaAlone(effect->added(tried));
      if (std::isfinite(sigma)) each.push_back(sigma > kNoNoise * whole ? sigma / tried : 0.0);
    }
    if (each.empty()) break;
    std::ranges::nth_element(each, each.begin() + static_cast<std::ptrdiff_t>(each.size() / 2));
    const double per_amount = each[each.size() / 2];
    expected = per_amount > 0.0 ? kExpectedSigma / per_amount : 0.0;
    if (!(expected > 0.0)) break;
  }
  if (!(expected > 0.0) || !std::isfinite(expected)) {
    own.power.objection = "the nominal model takes all that it adds";
    own.settled = true;
    return;
  }
  own.ln_most = std::log(std::min(largest, kLargest * expected));
  own.ln_expected = std::min(std::log(expected), own.ln_most);
}

}  // namespace

std::size_t CausePower::found() const {
  return static_cast<std::size_t>(std::ranges::count(trials, true, &PlantedOutcome::found));
}
std::size_t CausePower::with_others() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(trials, [](const PlantedOutcome& one) { return !one.others.empty(); }));
}
std::size_t CausePower::beyond() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      trials, [&](const PlantedOutcome& one) { return size && one.amount >= size->value; }));
}
std::size_t CausePower::found_beyond() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      trials, [&](const PlantedOutcome& one) { return size && one.amount >= size->value && one.found; }));
}
std::size_t DetectionPower::without_with_others() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(without, [](const PlantedOutcome& one) { return !one.others.empty(); }));
}

DetectionPower MeasureDetectionPower(const Study& study, const Diagnosis& diagnosis,
                                     const DiagnoseOptions& options) {
  DetectionPower power;
  if (!study.WithResponse(study.measured())) {
    power.refusal = "nothing can be planted into records of this kind";
    return power;
  }
  const PlantedRecords planting(study, diagnosis, options);
  if (!(planting.noise().innovation_sd() > kNoNoise * LargestOf(study.measured()))) {
    power.refusal = "the records have no noise: what is too small to be found cannot be told";
    return power;
  }
  std::vector<Growing> all = PlantableCauses(study, diagnosis, options, power);
  options.parallel(all.size(),
                   [&](std::size_t k) { FindSizes(study, diagnosis, planting, options, all[k]); });

  struct Task {
    Growing* own{};  // null: without an effect
    std::size_t trial{};
    double amount{};
  };
  const PlantingBase as_found = planting.BaseWithout({});
  power.without.resize(kWithoutEffect);
  std::mutex telling;
  for (bool first = true;; first = false) {
    std::vector<Task> tasks;
    for (std::size_t k = 0; first && k < kWithoutEffect; ++k) tasks.push_back({nullptr, k, 0.0});
    std::size_t still = 0;  // trials to come behind these, at most
    for (Growing& own : all) {
      if (own.settled) continue;
      const std::size_t made = own.power.trials.size();
      const std::vector<double> ln_sizes =
          NextLnSizes(own.TrialsBy(&PlantedOutcome::amount), own.ln_expected, own.ln_most, kTrialsAtATime);
      for (std::size_t k = 0; k < kTrialsAtATime; ++k)
        tasks.push_back({&own, made + k, std::exp(ln_sizes[k])});
      own.power.trials.resize(made + kTrialsAtATime);
      own.objections.resize(made + kTrialsAtATime);
      still += kMostTrials - made - kTrialsAtATime;
    }
    if (tasks.empty()) break;
    const std::size_t before = power.searches;
    options.parallel(tasks.size(), [&](std::size_t k) {
      const Task& task = tasks[k];
      if (task.own == nullptr) {
        const std::uint64_t draw = Mixed(options.seed, study.causes().size(), task.trial);
        power.without[task.trial] = planting.Search(as_found, nullptr, nullptr, 0.0, draw).planted;
      } else {
        Growing& own = *task.own;
        // Its own draws lie behind those that the first size was taken from.
        const std::uint64_t draw = Mixed(options.seed, own.power.cause, kSizing + task.trial);
        const auto effect = study.DrawEffect(own.power.cause, diagnosis.extended, draw);
        PlantingOutcome outcome;
        if (effect) outcome = planting.Search(own.base, own.rule, &*effect, task.amount, draw);
        own.power.trials[task.trial] = std::move(outcome.planted);
        own.objections[task.trial] = std::move(outcome.objection);
      }
      const std::scoped_lock lock(telling);
      ++power.searches;
      if (!options.progress) return;
      // Of those to come about half are needed.
      const double to_come =
          static_cast<double>(before + tasks.size() - power.searches) + 0.5 * static_cast<double>(still);
      const auto done = static_cast<double>(power.searches);
      options.progress(fmt::format("planting effects: {} records searched", power.searches),
                       done / (done + to_come));
    });
    for (Growing& own : all)
      if (!own.settled) own.Settle();
  }
  for (Growing& own : all) {
    own.Conclude();
    power.causes.push_back(std::move(own.power));
  }
  return power;
}

}  // namespace strainwave::analysis::diagnosis
