// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/trust_report.h"

#include <algorithm>
#include <vector>

#include <fmt/ranges.h>

#include "analysis/diagnosis/residual_views.h"
#include "bench/text.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using diagnosis::RangeError;
using diagnosis::Regressor;
using diagnosis::RegressorRange;
using diagnosis::Validity;
using Json = nlohmann::ordered_json;

constexpr std::size_t kRegionsShown = 3;

const RangeError& ErrorOf(const RegressorRange& range, bool extended) {
  return extended ? range.extended : range.nominal;
}

// Neighbouring ranges of one regressor in which a model fails.
struct FailingRegion {
  const Regressor* regressor{};
  double low{};
  double high{};
  double rmse{};  // the largest of its ranges, SI
};

struct TrustCounts {
  std::size_t holds{}, fails{}, too_few{};
};

TrustCounts Count(const DiagnosisReport& report, bool extended) {
  TrustCounts counts;
  for (const std::vector<RegressorRange>& ranges : report.result.trusted.over) {
    for (const RegressorRange& range : ranges) {
      const Validity validity = ErrorOf(range, extended).validity;
      ++(validity == Validity::kHolds   ? counts.holds
         : validity == Validity::kFails ? counts.fails
                                        : counts.too_few);
    }
  }
  return counts;
}

std::vector<FailingRegion> FailingRegions(const DiagnosisReport& report, bool extended) {
  std::vector<FailingRegion> regions;
  for (std::size_t k = 0; k < report.result.trusted.over.size(); ++k) {
    bool open = false;
    for (const RegressorRange& range : report.result.trusted.over[k]) {
      const RangeError& error = ErrorOf(range, extended);
      const bool fails = error.validity == Validity::kFails;
      if (fails && !open)
        regions.push_back({&report.input.study->regressors()[k], range.low, range.high, 0.0});
      if (fails) {
        regions.back().high = range.high;
        regions.back().rmse = std::max(regions.back().rmse, error.rmse);
      }
      open = fails;
    }
  }
  // The worst first; behind them those of time, which nobody can choose.
  std::ranges::stable_sort(regions, std::ranges::greater{}, &FailingRegion::rmse);
  std::ranges::stable_partition(regions,
                                [](const FailingRegion& region) { return region.regressor->name != "time"; });
  return regions;
}

std::string RegionText(const DiagnosisReport& report, const FailingRegion& region) {
  const Regressor& over = *region.regressor;
  const diagnosis::TitleParts title = diagnosis::SplitTitle(over);
  const double low = region.low * over.per_unit;
  const double high = region.high * over.per_unit;
  const std::string range = low == high ? Text("{:.4g}", low) : Text("{:.4g} to {:.4g}", low, high);
  return Text("{} {}{}{} ({:.3g} {})", title.quantity, range, title.unit.empty() ? "" : " ", title.unit,
              region.rmse * report.input.study->unit_per_si(), report.input.study->unit());
}

std::string_view NameOf(Validity validity) {
  switch (validity) {
    case Validity::kHolds:
      return "holds";
    case Validity::kFails:
      return "fails";
    case Validity::kTooFew:
      return "too_few_samples";
  }
  return {};
}

Json ErrorJson(const DiagnosisReport& report, const RangeError& error) {
  return {{"rmse", error.rmse * report.input.study->unit_per_si()}, {"result", NameOf(error.validity)}};
}

}  // namespace

bool HasTrustedRegions(const DiagnosisReport& report) {
  return std::ranges::any_of(report.result.trusted.over, [](const auto& ranges) { return !ranges.empty(); });
}

std::string TrustWords(const DiagnosisReport& report, bool extended) {
  const auto [holding, failing, too_few] = Count(report, extended);
  if (holding + failing == 0) return "these records are too short to say where";
  std::string text;
  if (failing == 0) {
    text = "everywhere in these records";
  } else if (holding == 0) {
    text = "nowhere in these records";
  } else {
    const std::vector<FailingRegion> regions = FailingRegions(report, extended);
    std::vector<std::string> words;
    for (std::size_t k = 0; k < std::min(regions.size(), kRegionsShown); ++k)
      words.push_back(RegionText(report, regions[k]));
    if (regions.size() > kRegionsShown) words.push_back(Text("{} more", regions.size() - kRegionsShown));
    text = Text("not at {}", fmt::join(words, ", "));
  }
  if (too_few > 0) text += Text("; too few samples in {} of {} ranges", too_few, holding + failing + too_few);
  return text;
}

Json TrustJson(const DiagnosisReport& report) {
  const diagnosis::TrustedRegions& trusted = report.result.trusted;
  Json over = Json::array();
  for (std::size_t k = 0; k < trusted.over.size(); ++k) {
    if (trusted.over[k].empty()) continue;
    const Regressor& regressor = report.input.study->regressors()[k];
    Json ranges = Json::array();
    for (const RegressorRange& range : trusted.over[k]) {
      ranges.push_back({{"low", range.low * regressor.per_unit},
                        {"high", range.high * regressor.per_unit},
                        {"samples", range.samples},
                        {"nominal", ErrorJson(report, range.nominal)},
                        {"extended", ErrorJson(report, range.extended)}});
    }
    over.push_back(
        {{"regressor", regressor.name}, {"title", regressor.title}, {"ranges", std::move(ranges)}});
  }
  return {{"noise", trusted.noise * report.input.study->unit_per_si()},
          {"unit", report.input.study->unit()},
          {"tolerated_excess", diagnosis::kToleratedExcess},
          {"over", std::move(over)}};
}

}  // namespace strainwave::bench
