// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// Largest less smallest; 0 for none.
double SpanOf(std::span<const double> values);

/// A line found in a residual: cos and sin of `order` × angle, with the drop of the weighted sum of squares
/// that it brings.
struct LinePeak {
  double order{};
  double drop{};
};

/// Lomb–Scargle search for lines over an unevenly sampled angle (or time: order in rad/s): the `count` peaks
/// of the generalised periodogram between two orders that stand out most from their surroundings, and second
/// of them the highest one, refined between grid points, at least one resolution cell (2π / span of the
/// angle) apart. Source: Zechmeister & Kürster, A&A 496 (2009) 577 (floating mean).
/// @param even_step  of the angle, where all samples with a weight are whole steps of it apart: each is a bin
///   of its own then, and the transform is as short as the record; 0 where they are not
std::vector<LinePeak> FindLines(std::span<const double> angle_rad, std::span<const double> residual,
                                std::span<const double> weights, double lowest_order, double highest_order,
                                std::size_t count, double even_step = 0.0);

/// Drop of the weighted sum of squares by a line of this very order, with a floating mean.
double LineDrop(std::span<const double> angle_rad, std::span<const double> residual,
                std::span<const double> weights, double order);

/// Independent orders in that range: the number of trials of the search.
double IndependentOrders(std::span<const double> angle_rad, double lowest_order, double highest_order);

/// Logarithm of the search locations that there are for a line of about this order, over those of all orders
/// in the range: what repeats has no scale, so that each octave of orders has the same share of what may be
/// found by chance. A line at a low order, where an octave has few locations, pays for few; one at the end of
/// the range pays for the octaves. Source: Dümbgen & Spokoiny, Ann. Statist. 29 (2001) 124, as for windows
/// below.
double LogSearchLocationsOfLine(double order, double lowest_order, double highest_order);

/// A segment of a regressor in which the residual's mean differs from zero.
struct WindowPeak {
  double centre{};
  double width{};  // full width
  double drop{};   // of the weighted sum of squares
};

/// Whether windows of that width move on by a quarter of it at each abscissa; not where that is lost in
/// rounding (millionths of a radian after 1e11 of them, or a width that is hardly above zero).
bool WindowsMove(std::span<const double> abscissa, double width);

/// The `count` best windows over widths from `narrowest` to `widest` (a factor of √2 apart) and all centres,
/// at least a width apart, strongest first.
std::vector<WindowPeak> FindWindows(std::span<const double> abscissa, std::span<const double> residual,
                                    std::span<const double> weights, double narrowest, double widest,
                                    std::size_t count);

/// The same with ends that lie between samples where they fit best: first one end, then the other, until none
/// moves. For windows whose ends are sharp, however wide.
std::vector<WindowPeak> FindSharpWindows(std::span<const double> abscissa, std::span<const double> residual,
                                         std::span<const double> weights, double narrowest, double widest,
                                         std::size_t count);

/// Logarithm of the search locations that there are for windows as wide as this one, over those for the
/// narrowest: a wide window has few locations, and pays for few. Each octave of widths has the same share of
/// what may be found by chance, so that the narrowest pay for the octaves; half of them, since a neighbouring
/// octave sees much the same. Source: Dümbgen & Spokoiny, Ann. Statist. 29 (2001) 124 (a bound for each scale
/// instead of one).
double LogSearchLocationsOfWidth(double width, double narrowest, double widest);

}  // namespace strainwave::analysis::diagnosis
