// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "analysis/transmission_error.h"

namespace strainwave::bench {

/// The transmission error of one measurement as it is drawn.
struct TransmissionErrorCurve {
  std::string label;  // "cycle 1"
  analysis::TransmissionError error;
};

/// The error over one output turn, both directions, above; its order spectrum below, the named orders
/// numbered in the spectrum and listed beside it with their amplitudes. The spectrum is that of the clockwise
/// sweep where there is one. `last` is laid over `first` in another colour. Writes `stem`.svg and `stem`.png.
///
/// @return the picture's path, as RenderPicture does.
/// @throws std::invalid_argument if a curve has neither direction.
/// @throws GnuplotError, std::filesystem::filesystem_error as RenderPicture does.
std::filesystem::path DrawTransmissionError(const std::string& title, const TransmissionErrorCurve& first,
                                            const std::optional<TransmissionErrorCurve>& last,
                                            const std::filesystem::path& stem);

}  // namespace strainwave::bench
