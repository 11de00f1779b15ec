// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// A filter of even samples without delay: its output at sample p is Σₖ taps[k + reach]·x[p + k].
struct KernelTaps {
  std::vector<double> taps;
  std::size_t reach{};  // taps to either side of the middle

  double At(std::span<const double> samples, std::size_t sample) const;
};

/// The low-pass that torque and terms pass: frequency response e⁻ˣ(1 + x + … + x⁵/5!), x = 1.19 (ωσ)², within
/// 10⁻³ of 1 up to half the frequency of half the power, ωσ = 1.94, and below 10⁻³ from 1.9 of it. Its
/// derivatives give those of a filtered signal, so that what is linear in the motion stays exact under it:
/// h∗(J q̈) = J (ḧ∗q) at every bandwidth.
///
/// The output is the `derivative`th derivative of h∗x at tₚ + shift. Good for σ ≥ 1.2 steps; the outermost
/// taps are below 10⁻⁵ of the largest.
KernelTaps MakeKernel(double sigma_s, double step_s, int derivative, double shift_s = 0.0);

/// The filter that changes nothing.
inline KernelTaps PassAll() { return {.taps = {1.0}, .reach = 0}; }

/// What the low-pass lets through that the one half an octave lower (σ times √2) does not.
KernelTaps MakeBandKernel(double sigma_s, double step_s, int derivative);

/// Standard deviation of the output for white noise of 1.
double NoiseGain(const KernelTaps& kernel);

/// Narrowest kernel, in steps.
inline constexpr double kNarrowestKernel = 1.24;
/// Output spacing, in σ, at which the filtered white noise is white again.
inline constexpr double kRowSpacing = 1.61;
/// ωσ of half the power.
inline constexpr double kHalfPower = 1.942;

}  // namespace strainwave::analysis::diagnosis
