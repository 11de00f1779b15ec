// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/study.h"
#include "analysis/parallel_for.h"
#include "analysis/statistics/random_effects.h"

/// What several specimens share, as an effect of their bench is shared, and what is one's own.
namespace strainwave::analysis::diagnosis {

/// A cause that was not named in a specimen is there all the same where chance makes a size as large in fewer
/// records than this.
inline constexpr double kChanceOfPresent = 0.01;

/// Standard deviation between specimens, over the mean, up to which they share an effect.
inline constexpr double kSharedSpread = 0.5;

/// As many specimens are asked for at most.
inline constexpr int kMostSpecimensAsked = 50;

struct DiagnosedSpecimen {
  const Study& study;
  const Diagnosis& diagnosis;
};

/// How large a cause is in one specimen, fitted beside everything else that was found there.
struct SpecimenSize {
  bool found{};                          // its own diagnosis names the cause
  std::optional<ParameterValue> amount;  // nothing where its records cannot show it, or leave it open
  std::optional<ParameterValue> phase;   // only where phases are compared
  double zero_p{1.0};  // chance of a size as large where it is not there, in as many places as were searched

  bool present() const { return found || zero_p < kChanceOfPresent; }
};

enum class Belonging {
  kShared,     // in all of them, about as large, and in phase: it comes with the bench
  kOwn,        // larger in some than in others
  kUndecided,  // neither is shown
};

/// One cause over all specimens.
struct SpecimenComparison {
  std::string name;                 // of the cause
  bool phases{};                    // sizes are compared with their phases, as vectors
  std::vector<SpecimenSize> sizes;  // one a specimen
  /// Of those whose size is known; nothing where these are fewer than two.
  std::optional<statistics::RandomEffects> effects;
  Belonging belonging{Belonging::kUndecided};
  /// Of an undecided one: how many specimens would decide it, about, if further ones are like these. Nothing
  /// where no number up to kMostSpecimensAsked would.
  std::optional<int> specimens_needed;

  std::size_t known() const;    // specimens whose size is known
  std::size_t present() const;  // of these, those that have it
};

struct CompareSpecimensOptions {
  /// True where phases of several specimens have one zero: an angle of the bench's encoders, not of a record.
  bool phases{};
  ParallelFor parallel{InTurn};  // over causes and specimens; changes no bit
};

/// Every cause that any diagnosis names, fitted in every specimen (FitPurpose::kReport) beside that one's
/// extended model, in the place of another form of the same cause; those that most have come first. Compared
/// is the first of its amounts that most of them have; with its phase where it has one and no other number,
/// since phases of different orders do not compare. Of such a vector the errors along it and across it are
/// known; what correlates both is taken for nothing, which is so in samples that are even over a turn.
///
/// Shared: all that can show it have it, the mean is away from zero (5 %), and the upper 95 % bound of the
/// standard deviation between specimens is at most kSharedSpread of the mean. Own: the lower bound is above
/// zero, and one of them does not have it or the deviation is above that share. Else undecided.
std::vector<SpecimenComparison> CompareSpecimens(std::span<const DiagnosedSpecimen> specimens,
                                                 const CompareSpecimensOptions& options);

/// An amount and its phase as a vector in the plane, in the unit of the amount.
statistics::GroupEstimate VectorOf(const ParameterValue& amount, const ParameterValue& phase);

}  // namespace strainwave::analysis::diagnosis
