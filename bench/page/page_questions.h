// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "bench/page/cycle_predictor.h"
#include "bench/page/journal_reader.h"
#include "bench/page/page_state.h"

namespace strainwave::bench {

/// Requests whose answer takes a disk or arithmetic: `GET /api/v1/cycles`, `alarms`, `measurements`, `live`,
/// `prediction`, `picture`. They are looked at here and answered later, from another thread.
class PageQuestions {
 public:
  /// @param predictor  folder; empty: nothing is predicted. @throws as CyclePredictor.
  PageQuestions(const CampaignFolder& folder, const std::filesystem::path& predictor,
                const std::filesystem::path& baseline);

  bool has_predictor() const { return predictor_.has_value(); }

  /// A question that will be answered, or why it is refused: then with a status of HTTP.
  struct Taken {
    int status{};
    std::string sentence{};  // empty: it will be answered
  };
  using Parameters = std::multimap<std::string, std::string>;
  using Answer = std::function<void(int status, std::string_view type, const std::string& body)>;

  /// @return nothing: that path is none of these.
  std::optional<Taken> Ask(const std::string& path, const Parameters& parameters,
                           const CampaignSnapshot& snapshot, const Answer& answer);

 private:
  bool Put(const std::string& path, const Parameters& parameters, const CampaignSnapshot& snapshot,
           const Answer& answer);

  JournalReader reader_;
  std::optional<CyclePredictor> predictor_;
};

}  // namespace strainwave::bench
