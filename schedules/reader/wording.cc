// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/wording.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace strainwave::schedules {
namespace {

std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::optional<std::string> NearestWord(std::string_view text, std::span<const std::string_view> words) {
  std::optional<std::string> nearest;
  std::size_t fewest = 0;
  for (const std::string_view word : words) {
    const std::size_t most = word.size() / 3;
    if (text.size() > word.size() + most) continue;  // also keeps a key of megabytes out of the table
    const std::size_t edits = EditDistance(text, word);
    if (edits > most || (nearest && edits >= fewest)) continue;
    nearest = std::string(word);
    fewest = edits;
  }
  return nearest;
}

std::string Alternatives(std::span<const std::string_view> words) {
  std::string prose;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) prose += i + 1 == words.size() ? " or " : ", ";
    prose += words[i];
  }
  return prose;
}

}  // namespace strainwave::schedules
