// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace strainwave::analysis::samples {

/// Where an angle that starts anew jumps: from its modulus to zero, or from one half of it to the other.
struct Wraps {
  double modulus{};               // in the unit of the values
  std::vector<std::size_t> rows;  // ascending; the first value after each jump
};

/// Finds an angle that starts anew at its zero: all values lie within one modulus, neighbours that differ by
/// more than half of it do so by the modulus and a step like those around.
/// @param turn    a whole turn in the unit of the values; moduli are whole turns, and whole parts of one.
/// @param returns one a value, or empty: true where a jump is the way of the shaft itself.
std::optional<Wraps> FindWraps(std::span<const double> values, double turn,
                               const std::vector<bool>& returns = {});

/// The share of the modulus that all but a twentieth of the steps keep to; from a half on, nobody can tell
/// which way they went.
double UsualStep(std::span<const double> values, const Wraps& wraps);

/// Takes the jumps away: the first value stays as it is.
void Unwrap(std::span<double> values, double modulus, const std::vector<bool>& returns = {});

/// The same for a follower of which is known how far it should go from value to value: each step becomes the
/// one of its moduli that comes nearest.
/// @return the largest distance of a step from the expected one, as a share of the modulus.
double UnwrapAlong(std::span<double> values, double modulus, std::span<const double> expected_steps);

}  // namespace strainwave::analysis::samples
