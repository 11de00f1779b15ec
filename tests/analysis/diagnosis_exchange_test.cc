// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/separable_study.h"
#include "analysis/units.h"
#include "tests/analysis/toy_terms.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::diagnosis::diagnosis_exchange_test {
namespace {

constexpr std::size_t kSamples = 20000;
constexpr double kNoise = 0.1;

double Wave(int periods, std::size_t sample) {
  return std::cos(kTwoPi * periods * static_cast<double>(sample) / static_cast<double>(kSamples));
}

// Waves of so many periods a record, the next one period more.
SeparableTerm Waves(int first_periods, int count) {
  std::vector<BasisFunction> basis_functions;
  for (int c = 0; c < count; ++c)
    basis_functions.emplace_back([=](std::size_t i) { return Wave(first_periods + c, i); });
  return TermOf(std::move(basis_functions));
}

// What was found of eight numbers among many search locations has less than nothing left by BIC, and so has
// what is not there at all, of one number and one location, only less so.
TEST(Exchange, PutsNothingThatChanceMakesInThePlaceOfWhatItDoesNot) {
  SeparableModel model;
  model.nominal.push_back(Waves(0, 1));
  const struct {
    const char* name;
    int periods;
    int count;
    double trials_factor;
  } causes[] = {{"loud", 300, 1, 1.0}, {"weak", 500, 8, 1e3}, {"absent", 700, 1, 1.0}};
  for (const auto& cause : causes) {
    model.causes.push_back(Waves(cause.periods, cause.count));
    model.rules.push_back({.name = cause.name,
                           .degrees_of_freedom = cause.count,
                           .known_by_size = true,
                           .trials_factor = cause.trials_factor});
  }
  model.measured = WhiteNoise(kSamples, kNoise, 11);
  for (std::size_t i = 0; i < kSamples; ++i) {
    model.measured[i] += 0.02 * Wave(300, i);
    for (int c = 0; c < 8; ++c) model.measured[i] += 0.0023 * Wave(500 + c, i);
  }
  model.block_length = kSamples / 100;
  model.noise_floor = kNoise;
  const SeparableStudy study(std::move(model));
  std::vector<std::string> names;
  for (const Finding& finding : Diagnose(study).causes) names.push_back(study.causes()[finding.index].name);
  EXPECT_EQ(names, (std::vector<std::string>{"loud", "weak"}));
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_exchange_test
