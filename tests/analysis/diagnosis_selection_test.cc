// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/separable_study.h"
#include "tests/analysis/toy_passes.h"

namespace strainwave::analysis::diagnosis::diagnosis_selection_test {
namespace {

// Names of the causes found, and of the nuisance terms without a cause in brackets.
std::string FoundIn(SeparableModel model) {
  const SeparableStudy study(std::move(model));
  const Diagnosis diagnosis = Diagnose(study);
  std::string found;
  for (const Finding& cause : diagnosis.causes) found += study.causes()[cause.index].name + " ";
  for (const Finding& nuisance_term : diagnosis.nuisance_terms)
    found += "(" + study.causes()[nuisance_term.index].name + ") ";
  return found;
}

TEST(Selection, TakesOnePlaceForSimplerThanACauseAtEachPass) {
  // A little other than the nuisance term of it has it, so that a cause with a size for each pass fits
  // better.
  SeparableModel model = NoiseAnd([](std::size_t i) {
    return (1.0 + 0.1 * std::cos(static_cast<double>(i / kOfPass))) * Bell(PlaceOf(i), 0.4, 0.05);
  });
  std::vector<BasisFunction> each_pass;
  for (std::size_t pass = 0; pass < kPasses; ++pass) {
    each_pass.emplace_back(
        [pass](std::size_t i) { return i / kOfPass == pass ? Bell(PlaceOf(i), 0.4, 0.05) : 0.0; });
  }
  Add(model, {.name = "disturbances"}, std::move(each_pass));
  Add(model, {.name = "place", .named = false}, {[](std::size_t i) { return Bell(PlaceOf(i), 0.4, 0.05); }});
  EXPECT_EQ(FoundIn(std::move(model)), "(place) ");
}

// A bell that its nuisance term has too narrow, beside a cause that is like what this leaves.
SeparableModel RoughlyDescribed(double size_of_cause,
                                const CauseRule& roughly = {.name = "roughly", .named = false},
                                const CauseRule& beside = {.name = "cause"}) {
  const BasisFunction cause = [](std::size_t i) {
    return Bell(PlaceOf(i), 0.3, 0.03) - Bell(PlaceOf(i), 0.5, 0.03);
  };
  SeparableModel model =
      NoiseAnd([&](std::size_t i) { return 3.0 * Bell(PlaceOf(i), 0.39, 0.1) + size_of_cause * cause(i); });
  Add(model, roughly, {[](std::size_t i) { return Bell(PlaceOf(i), 0.4, 0.1); }});
  Add(model, beside, {cause});
  return model;
}

TEST(Selection, NamesNothingForWhatARoughNuisanceTermLeaves) {
  EXPECT_EQ(FoundIn(RoughlyDescribed(0.0)), "(roughly) ");
}

TEST(Selection, NamesNothingForWhatACauseOfRoughShapeLeaves) {
  // A bell that lags by a little explains as much as the second cause; not where that is really there.
  EXPECT_EQ(FoundIn(RoughlyDescribed(0.0, {.name = "lagging"})), "lagging ");
  EXPECT_EQ(FoundIn(RoughlyDescribed(1.0, {.name = "lagging"})), "lagging cause ");
  EXPECT_EQ(FoundIn(RoughlyDescribed(0.0, {.name = "contact", .misfit_share = 0.02})), "contact ");
}

// What takes anything that is left somewhere has to bring a share of what others do, beside them.
TEST(Selection, NamesNoShapelessCauseForLessThanItsShareBesideAnother) {
  const CauseRule shapeless{.name = "push", .least_share = 0.02};
  EXPECT_EQ(FoundIn(RoughlyDescribed(0.0, {.name = "exactly"}, shapeless)), "exactly ");
  EXPECT_EQ(FoundIn(RoughlyDescribed(1.0, {.name = "exactly"}, shapeless)), "exactly push ");
}

TEST(Selection, NamesACauseThatIsLargeBesideANuisanceTerm) {
  EXPECT_EQ(FoundIn(RoughlyDescribed(1.0)), "cause (roughly) ");
}

TEST(Selection, BelievesACauseThatOneBlockAloneShows) {
  const BasisFunction start = [](std::size_t i) { return std::exp(-static_cast<double>(i) / 30.0); };
  SeparableModel model = NoiseAnd(start);
  model.block_length = kOfPass;
  Add(model, {.name = "settling"}, {start});
  EXPECT_EQ(FoundIn(std::move(model)), "settling ");
}

TEST(Selection, FindsTwoOfWhichOneShowsNothingAlone) {
  // The small one hides behind the large one: of their sum it is free alone.
  const BasisFunction large = [](std::size_t i) { return std::cos(0.05 * static_cast<double>(i)); };
  const BasisFunction small = [&](std::size_t i) {
    return std::sin(0.05 * static_cast<double>(i)) - 0.3 * large(i);
  };
  const double hidden = 0.3 / (1.0 + 0.3 * 0.3);
  const BasisFunction sum = [&](std::size_t i) { return 0.4 * (large(i) + hidden * small(i)); };
  SeparableModel model = NoiseAnd(sum);
  // A curve that is free enough to follow both.
  Add(model, {.name = "mimic"},
      {sum, [](std::size_t i) { return std::cos(0.11 * static_cast<double>(i)); },
       [](std::size_t i) { return std::sin(0.11 * static_cast<double>(i)); },
       [](std::size_t i) { return std::cos(0.17 * static_cast<double>(i)); }});
  Add(model, {.name = "large"}, {large});
  Add(model, {.name = "small"}, {small});
  EXPECT_EQ(FoundIn(std::move(model)), "large small ");
}

// Both follow it; the nuisance term has a number more, of which it makes nothing.
TEST(Selection, NamesTwoCausesRatherThanANuisanceTermThatIsNoBetter) {
  const BasisFunction one = [](std::size_t i) { return std::cos(0.05 * static_cast<double>(i)); };
  const BasisFunction other = [](std::size_t i) { return std::sin(0.05 * static_cast<double>(i)); };
  const BasisFunction sum = [&](std::size_t i) { return 0.1 * (one(i) + other(i)); };
  SeparableModel model = NoiseAnd(sum);
  Add(model, {.name = "curve", .named = false},
      {sum, [](std::size_t i) { return std::cos(0.11 * static_cast<double>(i)); }});
  Add(model, {.name = "one"}, {one});
  Add(model, {.name = "other"}, {other});
  EXPECT_EQ(FoundIn(std::move(model)), "other one ");
}

// Of eight numbers one is the size; as little as it is away from zero, chance does not make all eight. BIC
// asks too much of so many: for such a cause the p-value is decisive.
TEST(Selection, AsksLessOfTheSizeOfWhatChanceDoesNotMake) {
  constexpr double kSize = 0.1;
  const auto bell = [](int k) {
    return [k](std::size_t i) { return Bell(PlaceOf(i), 0.1 + 0.1 * k, 0.02); };
  };
  SeparableModel model = NoiseAnd([&](std::size_t i) {
    double sum = 0.0;
    for (int k = 0; k < 8; ++k) sum += (k == 0 ? 0.08 : kSize) * bell(k)(i);
    return sum;
  });
  std::vector<BasisFunction> basis_functions;
  for (int k = 0; k < 8; ++k) basis_functions.push_back(bell(k));
  Add(model, {.name = "bells", .parameters = {{"size_0", "1", -10.0, 10.0, true}}, .known_by_size = true},
      std::move(basis_functions));
  EXPECT_EQ(FoundIn(std::move(model)), "bells ");
}

// Four numbers, clearer than chance makes them (p about 1e-4) and dearer than what they bring.
TEST(Selection, TellsNoNuisanceTermThatCostsMoreThanItBrings) {
  const auto curve = [](double size) {
    const auto wave = [](double rate) {
      return [rate](std::size_t i) { return std::cos(rate * static_cast<double>(i)); };
    };
    const std::vector<BasisFunction> waves{wave(0.05), wave(0.11), wave(0.17), wave(0.23)};
    SeparableModel model = NoiseAnd(
        [&](std::size_t i) { return size * (waves[0](i) + waves[1](i) + waves[2](i) + waves[3](i)); });
    Add(model, {.name = "curve", .named = false}, waves);
    return model;
  };
  EXPECT_EQ(FoundIn(curve(0.021)), "");
  EXPECT_EQ(FoundIn(curve(0.04)), "(curve) ");
}

// One block holds nearly all that there is of it: without that the rest can but extrapolate.
TEST(Selection, PredictsWithinABlockWhatNoOtherBlockShows) {
  constexpr std::size_t kOfBlock = 30;
  const BasisFunction basis_function = [](std::size_t i) {
    return i / kOfBlock == 17 ? 1.0 : 0.004 * std::sin(0.7 * static_cast<double>(i));
  };
  SeparableModel model = NoiseAnd([&](std::size_t i) { return 0.25 * basis_function(i); });
  model.block_length = kOfBlock;
  Add(model, {.name = "drag"}, {basis_function});
  EXPECT_EQ(FoundIn(std::move(model)), "drag ");
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_selection_test
