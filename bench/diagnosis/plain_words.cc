// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/plain_words.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "bench/text.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;

// "fewer than one of 10 000 such records".
std::string ChanceText(double p_value) {
  constexpr std::array<const char*, 8> kRecords{"10",      "100",       "1000",       "10 000",
                                                "100 000", "1 million", "10 million", "100 million"};
  const double decades = -std::log10(std::clamp(p_value, 1e-300, 1.0));
  const auto below = static_cast<std::size_t>(decades);  // p ≤ 10^-below
  if (below == 0) return "chance may show as much";
  return Text("chance shows as much in fewer than one of {} such records",
              below > kRecords.size() ? "a billion" : kRecords[below - 1]);
}

std::string WhatIsMissing(const DiagnosisReport& report, const diagnosis::Finding& largest) {
  const std::string& sentence = report.input.study->causes()[largest.index].sentence;
  // What it is; what usually makes it stands behind.
  std::string text = sentence.substr(0, sentence.find_first_of(":;"));
  text += Text(" ({:.0f} % of what the simulation misses", 100.0 * largest.share_of_explainable);
  const std::size_t others = report.result.causes.size() - 1;
  if (others > 0) text += others == 1 ? ", and one smaller effect" : Text(", and {} smaller effects", others);
  return text + ")";
}

std::string HowSure(const DiagnosisReport& report, const diagnosis::Finding& largest) {
  std::string text = ChanceText(largest.evidence.p_value);
  const diagnosis::GainEstimate& gain = report.result.gain;
  if (gain.low > 0.0)
    text += Text("; on data that no fit has seen the error falls by {:.2g} %", 100.0 * gain.reduction);
  const std::size_t rivals = largest.indistinguishable_from.size();
  if (rivals == 1) text += "; but something else would explain these records as well";
  if (rivals > 1) text += Text("; but {} other explanations would do as well", rivals);
  return text;
}

PlainWords OfNothing(const DiagnosisReport& report) {
  PlainWords words;
  words.how_sure = report.power && report.power->refusal.empty()
                       ? "effects from the sizes under \"power\" on would have been found"
                       : "diagnose --power measures how large an effect would have been found here";
  words.what_to_do = report.result.nuisance_terms.empty()
                         ? "nothing: go on with the simulation as it is"
                         : "put right the number of the record that stands under \"to correct\"";
  return words;
}

}  // namespace

std::vector<const diagnosis::Finding*> LargestFirst(const std::vector<diagnosis::Finding>& findings) {
  std::vector<const diagnosis::Finding*> order;
  for (const diagnosis::Finding& finding : findings) order.push_back(&finding);
  std::ranges::stable_sort(order, std::greater<>(), &diagnosis::Finding::share_of_explainable);
  return order;
}

PlainWords PlainWordsOf(const DiagnosisReport& report) {
  const diagnosis::Diagnosis& result = report.result;
  if (result.verdict == diagnosis::Verdict::kNoEffect) return OfNothing(report);
  PlainWords words;
  if (result.causes.empty()) {
    double p_value = 1.0;
    for (const diagnosis::Finding& term : result.nuisance_terms)
      p_value = std::min(p_value, term.evidence.p_value);
    words.how_sure = ChanceText(p_value);
    words.what_to_do = "measure again as under \"next\": what comes back belongs to the gear or the bench";
    return words;
  }
  const diagnosis::Finding& largest = *LargestFirst(result.causes).front();
  words.what_is_missing = WhatIsMissing(report, largest);
  words.how_sure = HowSure(report, largest);
  words.what_to_do = report.input.study->causes()[largest.index].what_to_do;
  if (words.what_to_do.empty() ||
      (!largest.indistinguishable_from.empty() && !MeasurementsToSettle(report).empty()))
    words.what_to_do = "measure what tells them apart, as under \"next\"";
  return words;
}

}  // namespace strainwave::bench
