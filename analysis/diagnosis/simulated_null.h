// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/study.h"
#include "analysis/parallel_for.h"

namespace strainwave::analysis::diagnosis {

/// Records as they would be without any named cause, with the numbers of this nominal model: simulated anew
/// for each draw. Null where no such record can be simulated. Several threads may ask at once.
using SimulateNull =
    std::function<std::unique_ptr<Study>(std::span<const ParameterValue> nominal, std::uint64_t draw)>;

/// What simulated records without a cause show of it: in how many of `simulated` the same search names it
/// with as much evidence as the measured record gives.
struct NullEvidence {
  int simulated{};
  int as_strong{};
  double strongest{};  // BIC, of all of them

  /// Share of records without the cause that claim as much, by one of the measured itself and these
  /// ([Davison](docs/sources.md#davison-1997), 4.11).
  double p_value() const { return (as_strong + 1.0) / (simulated + 1.0); }
};

struct NamedClaim {
  std::string name;
  double delta_bic{};
};

/// The claims that a search makes of one simulated record.
using SearchNull = std::function<std::vector<NamedClaim>(const Study& study)>;

/// Simulates and searches until each claim is refused or clear, at most 19 times
/// ([Besag](docs/sources.md#besag-1991)): refused as soon as two records claim as much, clear early where its
/// evidence is many times the strongest.
/// @returns one a claim; all zeros where nothing could be simulated.
std::vector<NullEvidence> JudgeBySimulation(std::span<const NamedClaim> claims,
                                            std::span<const ParameterValue> nominal,
                                            const SimulateNull& simulate, const SearchNull& search,
                                            std::uint64_t seed, const ParallelFor& parallel);

/// A claim that records without its cause make, too.
bool IsRefused(const NullEvidence& evidence);

}  // namespace strainwave::analysis::diagnosis
