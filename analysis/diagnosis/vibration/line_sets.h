// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "analysis/diagnosis/vibration/starts.h"

/// Lines over the shaft angle that belong together: choosing and fitting them.
namespace strainwave::analysis::diagnosis {

inline constexpr std::size_t kMostLines = 10;  // of one term

/// A term of lines over the angle without lines yet, observable in all channels.
VibrationTerm LinesTerm(const VibrationResidual& residual, std::size_t index);

/// Power of all channels at an order, also of one beyond half the sampling rate, whose samples are folded.
double PowerAt(const VibrationResidual& residual, double order);

/// Drop that each line of a term brings, of all channels, over what its coefficients cost there.
std::vector<double> LineGains(const TermFit& fit);

/// Fits those of the `candidates` that stand out in the spectrum, then drops those that do not pay; nothing
/// where fewer than `fewest` do.
/// @param may_be  whether some of these lines would be the cause: if not, none is fitted
std::optional<TermFit> FitPayingLines(
    const VibrationResidual& residual, VibrationTerm term, const std::vector<LineOrder>& candidates,
    std::size_t fewest,
    const std::function<bool(std::span<const LineOrder>)>& may_be = [](std::span<const LineOrder>) {
      return true;
    });

/// Scale of known orders that agrees best with the spectrum, where the shaft's own lines leave it open.
double BestScale(const VibrationResidual& residual, const std::vector<double>& orders);

/// Whether the shaft's lines leave it open by more than a line's sharpness where an order stands.
bool ScaleIsOpen(const VibrationSamples& samples, double order);

}  // namespace strainwave::analysis::diagnosis
