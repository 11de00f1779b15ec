// SPDX-License-Identifier: Apache-2.0
#include "bench/page/cycles.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>

#include <fmt/core.h>

#include "analysis/quantities.h"
#include "bench/campaign/cycle_results.h"
#include "bench/page/trend_lines.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

constexpr int kMostBinsAsked = 5000;
constexpr std::size_t kMostQuantities = 16;
constexpr std::size_t kLongestQuantity = 64;
constexpr std::array kTrends{analysis::quantities::kK1,   analysis::quantities::kK2,
                             analysis::quantities::kK3,   analysis::quantities::kEMax,
                             analysis::quantities::kEAvg, analysis::quantities::kLostMotion};

std::vector<std::string> Quantities(std::string_view text) {
  std::vector<std::string> names;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::string_view name = text.substr(0, comma);
    const bool is_name =
        !name.empty() && name.size() <= kLongestQuantity && std::ranges::all_of(name, [](char c) {
          return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
        });
    if (!is_name || names.size() == kMostQuantities) {
      throw std::invalid_argument(
          fmt::format("quantities (expected at most {} names of results, separated by commas: "
                      "k1_Nm_per_rad,e_max_arcmin)",
                      kMostQuantities));
    }
    if (std::ranges::find(names, name) == names.end()) names.emplace_back(name);
    if (comma == std::string_view::npos) return names;
    text.remove_prefix(comma + 1);
  }
}

json BinsJson(const CycleBins& bins) {
  json all{{"min", json::array()},
           {"max", json::array()},
           {"last", json::array()},
           {"last_standard_error", json::array()},
           {"flagged", json::array()}};
  for (const CycleBin& bin : bins.bins()) {
    const auto number = [&](double value) {
      return bin.count > 0 && std::isfinite(value) ? json(value) : json();
    };
    all["min"].push_back(number(bin.min));
    all["max"].push_back(number(bin.max));
    all["last"].push_back(number(bin.last));
    all["last_standard_error"].push_back(number(bin.last_standard_error));
    all["flagged"].push_back(bin.flagged);
  }
  return all;
}

}  // namespace

int WholeNumber(const std::string& name, const std::string& text, int least, int most) {
  int value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least || value > most) {
    throw std::invalid_argument(
        fmt::format("{} = '{:.40}' (expected a whole number from {} to {})", name, text, least, most));
  }
  return value;
}

CyclesQuery ParseCyclesQuery(const std::multimap<std::string, std::string>& parameters) {
  CyclesQuery query;
  for (const analysis::Quantity& trend : kTrends) query.quantities.emplace_back(trend.name);
  for (const auto& [name, text] : parameters) {
    if (parameters.count(name) > 1) {
      throw std::invalid_argument(fmt::format("{:.40} stands there twice (expected once)", name));
    }
    if (name == "from") {
      query.from = WholeNumber(name, text, 1, kLastCycle);
    } else if (name == "to") {
      query.to = WholeNumber(name, text, 1, kLastCycle);
    } else if (name == "points") {
      query.points = WholeNumber(name, text, 1, kMostBinsAsked);
    } else if (name == "quantities") {
      query.quantities = Quantities(text);
    } else {
      throw std::invalid_argument(
          fmt::format("'{:.40}' is not known (expected from, to, points or quantities)", name));
    }
  }
  if (query.to != 0 && query.to < query.from) {
    throw std::invalid_argument(fmt::format(
        "to = {} is before from = {} (expected the same cycle or a later one)", query.to, query.from));
  }
  return query;
}

CycleBins::CycleBins(int from, int to, int points) : from_(from), to_(to) {
  const int cycles = std::max(0, to - from + 1);
  width_ = std::max(1, (cycles + points - 1) / points);
  bins_.resize(static_cast<std::size_t>((cycles + width_ - 1) / width_));
}

int CycleBins::EndOf(std::size_t bin) const {
  return std::min(to_, from_ + (static_cast<int>(bin) + 1) * width_ - 1);
}

void CycleBins::Add(int cycle, const Result& result) {
  CycleBin& bin = bins_.at(static_cast<std::size_t>((cycle - from_) / width_));
  bin.min = bin.count == 0 ? result.value : std::min(bin.min, result.value);
  bin.max = bin.count == 0 ? result.value : std::max(bin.max, result.value);
  bin.last = result.value;
  bin.last_standard_error = result.standard_error;
  bin.flagged += IsSound(result) ? 0 : 1;
  ++bin.count;
}

nlohmann::json CyclesJson(const Journal& journal, const CyclesQuery& query,
                          const schedules::StopCriteria& stop) {
  const int last = std::max(0, journal.LastCompleteCycle());
  const int to = query.to == 0 ? last : std::min(query.to, last);
  json quantities = json::object();
  json ends = json::array();
  const CycleBins none(query.from, to, query.points);
  for (std::size_t bin = 0; bin < none.bins().size(); ++bin) ends.push_back(none.EndOf(bin));
  std::map<std::string, CycleBins> bins;
  for (const std::string& quantity : query.quantities) bins.emplace(quantity, none);
  if (!none.bins().empty()) {
    journal.ForEachResultOf(query.quantities, query.from, to, [&](const CycleResult& found) {
      bins.at(found.result.quantity).Add(found.cycle, found.result);
    });
  }
  for (const auto& [quantity, of_quantity] : bins) quantities[quantity] = BinsJson(of_quantity);
  return {{"from", query.from},
          {"to", to},
          {"cycles_complete", last},
          {"bin_cycles", none.width()},
          {"cycle", std::move(ends)},
          {"quantities", std::move(quantities)},
          {"lines", TrendLinesJson(journal, stop, query.quantities)}};
}

}  // namespace strainwave::bench
