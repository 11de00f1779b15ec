// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/prediction/worth.h"

namespace strainwave::bench {

/// What a network is worth in one use, by the name of the split that is like it.
struct UseWorth {
  std::string split;
  analysis::prediction::Worth worth;
};

/// `{"any": …, "sentence": …, "uses": [{"split": …, "network_error_percent": …, "same_error_percent": …,
/// "gain_percent": …, "gain_se_percent": …, "any": …}]}`; `any` of all is whether it is worth something in
/// one use. The sentence tells the uses in which it is worth nothing, and is empty where there are none.
nlohmann::ordered_json JsonOf(const std::vector<UseWorth>& uses, bool classes);

/// Of a predictor's training (predictor_file.h): the sentence.
std::string WorthSentence(const nlohmann::ordered_json& training);

/// Whether that training has found it to be worth nothing in any use.
bool IsWorthNothing(const nlohmann::ordered_json& training);

}  // namespace strainwave::bench
