// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace strainwave::analysis::features {

/// Every `factor`-th sample after a low pass that leaves nothing above the new Nyquist frequency: a sinc
/// under a Hann window, 16 new samples to either side, flat to 0.8 of the new Nyquist frequency within 0.1 %
/// and down by 60 dB from 1.1 of it on. Beyond its ends the signal is its own mirror image.
/// @param signal  at least one sample.
/// @param factor  1 or more; 1 changes nothing.
/// @return signal.size() / factor values, rounded up.
/// @throws std::invalid_argument as said.
/// Source: Oppenheim & Schafer, Discrete-Time Signal Processing, section 4.6.
std::vector<double> Decimate(std::span<const double> signal, int factor);

}  // namespace strainwave::analysis::features
