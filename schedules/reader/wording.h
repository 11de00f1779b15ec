// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace strainwave::schedules {

/// The word that `text` was probably meant to be: the one with the fewest single-character edits
/// (Levenshtein), if they are at most a third of its length; the first of several.
std::optional<std::string> NearestWord(std::string_view text, std::span<const std::string_view> words);

/// "us, ms or s".
std::string Alternatives(std::span<const std::string_view> words);

}  // namespace strainwave::schedules
