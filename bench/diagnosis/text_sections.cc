// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/text_sections.h"

#include <algorithm>
#include <cmath>

#include "bench/plots/script.h"
#include "bench/text.h"

namespace strainwave::bench {

using analysis::diagnosis::ParameterValue;

std::string Wrapped(const std::string& head, const std::string& words, std::size_t indent) {
  std::string text;
  std::string line = head;
  std::size_t at = 0;
  while (at < words.size()) {
    const std::size_t end = std::min(words.find(' ', at), words.size());
    const std::string word = words.substr(at, end - at);
    if (line.size() + word.size() + 1 > kLineWidth && line.size() > indent) {
      text += line + "\n";
      line = std::string(indent, ' ') + word;
    } else {
      line += line.empty() || line.back() == ' ' ? word : " " + word;
    }
    at = end + 1;
  }
  return text + line + "\n";
}

std::string Section(std::string_view name, const std::string& words) {
  return Wrapped(Text("{:<13}", name), words, 13);
}

std::string ValueText(const ParameterValue& parameter) {
  if (!std::isfinite(parameter.standard_error)) return "–";
  const std::string unit = parameter.unit == "1" ? "" : parameter.unit;
  std::string text = EstimateText({parameter.value, parameter.standard_error}, unit);
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

}  // namespace strainwave::bench
