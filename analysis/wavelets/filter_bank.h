// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace strainwave::analysis::wavelets {

/// The four filters of an orthogonal wavelet, all of one even length, each with PyWavelets' order and signs:
///   decomposition low-pass  = reconstruction low-pass, reversed,
///   decomposition high-pass [k] = (−1)^(k+1) reconstruction low-pass [k],
///   reconstruction high-pass = decomposition high-pass, reversed.
struct FilterBank {
  std::string name;
  std::vector<double> decomposition_low;
  std::vector<double> decomposition_high;
  std::vector<double> reconstruction_low;
  std::vector<double> reconstruction_high;

  std::size_t length() const { return decomposition_low.size(); }
};

/// @param name  haar, db1 to db20, sym2 to sym20 or coif1 to coif5.
/// @throws std::invalid_argument for any other name.
/// Source of the numbers: Daubechies, Ten Lectures on Wavelets (1992), chapters 6 and 8, to the digits that
/// PyWavelets gives; those of the symlets deviate from the exact solution by up to 1.5e-11 there, and here.
FilterBank FilterBankOf(std::string_view name);

/// Every name that `FilterBankOf` takes.
std::vector<std::string> WaveletNames();

}  // namespace strainwave::analysis::wavelets
