// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "analysis/diagnosis/separable_study.h"
#include "tests/analysis/toy_terms.h"
#include "tests/analysis/white_noise.h"

// A record that comes by the same places, 0 to 1, several times.
namespace strainwave::analysis::diagnosis {

inline constexpr std::size_t kPasses = 8;
inline constexpr std::size_t kOfPass = 150;  // samples
inline constexpr double kNoise = 0.2;

inline double PlaceOf(std::size_t i) {
  return static_cast<double>(i % kOfPass) / static_cast<double>(kOfPass);
}

inline double Bell(double place, double centre, double width) {
  const double away = (place - centre) / width;
  return std::exp(-0.5 * away * away);
}

/// Its nominal model is a constant.
inline SeparableModel NoiseAnd(const BasisFunction& hidden) {
  SeparableModel model;
  model.measured = WhiteNoise(kPasses * kOfPass, kNoise, 17);
  for (std::size_t i = 0; i < model.measured.size(); ++i) model.measured[i] += hidden(i);
  model.nominal.push_back(TermOf({[](std::size_t) { return 1.0; }}));
  model.block_length = kOfPass / 2;
  model.noise_floor = kNoise;
  model.unit = "V";
  return model;
}

/// A cause with a number for each shape.
inline void Add(SeparableModel& model, CauseRule rule, std::vector<BasisFunction> basis_functions) {
  rule.degrees_of_freedom = static_cast<int>(basis_functions.size());
  model.causes.push_back(TermOf(std::move(basis_functions)));
  model.rules.push_back(std::move(rule));
}

}  // namespace strainwave::analysis::diagnosis
