// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/network_worth.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace strainwave::bench {
namespace {

using Json = nlohmann::ordered_json;

std::string Comparison(const UseWorth& use, bool classes) {
  const analysis::prediction::Worth& worth = use.worth;
  std::string text =
      classes
          ? fmt::format("on {} its accuracy is {:.1f} %, that of always saying the commonest class {:.1f} %",
                        use.split, 100.0 - worth.network_error_percent, 100.0 - worth.same_error_percent)
          : fmt::format("on {} its error is {:.3f} %, that of always saying the mean {:.3f} %", use.split,
                        worth.network_error_percent, worth.same_error_percent);
  if (worth.gain_percent > 0.0) {
    text +=
        fmt::format(" (a gain of {:.2g} ± {:.2g} % is chance)", worth.gain_percent, worth.gain_se_percent);
  }
  return text;
}

std::string Sentence(const std::vector<UseWorth>& uses, bool classes) {
  std::string text;
  for (const UseWorth& use : uses) {
    if (use.worth.any()) continue;
    text += (text.empty() ? "" : "; ") + Comparison(use, classes);
  }
  if (text.empty()) return text;
  const bool any = std::ranges::any_of(uses, [](const UseWorth& use) { return use.worth.any(); });
  return fmt::format("This network is worth nothing{}: {}.", any ? " in one of its uses" : "", text);
}

}  // namespace

Json JsonOf(const std::vector<UseWorth>& uses, bool classes) {
  Json list = Json::array();
  for (const UseWorth& use : uses) {
    list.push_back({{"split", use.split},
                    {"network_error_percent", use.worth.network_error_percent},
                    {"same_error_percent", use.worth.same_error_percent},
                    {"gain_percent", use.worth.gain_percent},
                    {"gain_se_percent", use.worth.gain_se_percent},
                    {"any", use.worth.any()}});
  }
  const bool any = std::ranges::any_of(uses, [](const UseWorth& use) { return use.worth.any(); });
  return {{"any", any}, {"sentence", Sentence(uses, classes)}, {"uses", std::move(list)}};
}

std::string WorthSentence(const Json& training) {
  return training.contains("worth") ? training.at("worth").at("sentence").get<std::string>() : "";
}

bool IsWorthNothing(const Json& training) {
  return training.contains("worth") && !training.at("worth").at("any").get<bool>();
}

}  // namespace strainwave::bench
