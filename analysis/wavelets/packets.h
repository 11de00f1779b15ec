// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/wavelets/transform.h"

/// Wavelet packets: details are decomposed as approximations are, into 2^levels leaves of one length.
namespace strainwave::analysis::wavelets {

inline constexpr int kMostPacketLevels = 16;

/// Owned by the caller, and used again for the next signal.
struct Packets {
  std::vector<std::vector<double>> leaves;  // natural order: aaa, aad, ada, …
  std::vector<double> spare;
};

/// @throws std::invalid_argument if the signal is empty or levels is not in 1 … 16.
void DecomposePackets(std::span<const double> signal, const FilterBank& bank, Border border, int levels,
                      Packets& out);

/// The signal of `samples` values again.
/// @throws std::invalid_argument if the number of leaves is no power of two or lengths do not fit.
std::vector<double> ReconstructPackets(const std::vector<std::vector<double>>& leaves, const FilterBank& bank,
                                       Border border, std::size_t samples);

/// Path of each leaf in natural order: what was taken at each level, from the signal down ("aad").
std::vector<std::string> PacketPaths(int levels);

/// Which leaf, in natural order, has the 1st, 2nd, … lowest frequency band: a high-pass turns the band that
/// it passes about, so that neighbours differ in one letter (Gray code).
std::vector<std::size_t> FrequencyOrder(int levels);

}  // namespace strainwave::analysis::wavelets
