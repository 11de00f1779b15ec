// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/zero_padded_inverse_fft.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/units.h"
#include "analysis/vector_clones.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Stockham's transform, halves to halves: `half` pairs of blocks of `block` numbers.
STRAINWAVE_VECTOR_CLONES
void Pass(const float* __restrict real, const float* __restrict imaginary, float* __restrict next_real,
          float* __restrict next_imaginary, const std::complex<float>* directions, std::size_t half,
          std::size_t block) {
  for (std::size_t p = 0; p < half; ++p) {
    // A direction for a transform of twice `half`, out of those for all.
    const float turn_real = directions[p * (block / ZeroPaddedInverseFft::kLists)].real();
    const float turn_imaginary = directions[p * (block / ZeroPaddedInverseFft::kLists)].imag();
    const float* const a_real = real + p * block;
    const float* const a_imaginary = imaginary + p * block;
    const float* const b_real = real + (p + half) * block;
    const float* const b_imaginary = imaginary + (p + half) * block;
    float* const sum_real = next_real + 2 * p * block;
    float* const sum_imaginary = next_imaginary + 2 * p * block;
    float* const turned_real = sum_real + block;
    float* const turned_imaginary = sum_imaginary + block;
    for (std::size_t i = 0; i < block; ++i) {
      sum_real[i] = a_real[i] + b_real[i];
      sum_imaginary[i] = a_imaginary[i] + b_imaginary[i];
      const float less_real = a_real[i] - b_real[i];
      const float less_imaginary = a_imaginary[i] - b_imaginary[i];
      turned_real[i] = less_real * turn_real - less_imaginary * turn_imaginary;
      turned_imaginary[i] = less_real * turn_imaginary + less_imaginary * turn_real;
    }
  }
}

// The first of these, where the second halves are zero.
STRAINWAVE_VECTOR_CLONES
void FirstPass(const float* __restrict real, const float* __restrict imaginary, float* __restrict next_real,
               float* __restrict next_imaginary, const std::complex<float>* directions, std::size_t half) {
  constexpr std::size_t kBlock = ZeroPaddedInverseFft::kLists;
  for (std::size_t p = 0; p < half; ++p) {
    const float turn_real = directions[p].real();
    const float turn_imaginary = directions[p].imag();
    for (std::size_t i = 0; i < kBlock; ++i) {
      const float own_real = real[p * kBlock + i];
      const float own_imaginary = imaginary[p * kBlock + i];
      next_real[2 * p * kBlock + i] = own_real;
      next_imaginary[2 * p * kBlock + i] = own_imaginary;
      next_real[(2 * p + 1) * kBlock + i] = own_real * turn_real - own_imaginary * turn_imaginary;
      next_imaginary[(2 * p + 1) * kBlock + i] = own_real * turn_imaginary + own_imaginary * turn_real;
    }
  }
}

}  // namespace

void ZeroPaddedInverseFft::Clear(std::size_t points) {
  points_ = points;
  real_.assign(points * kLists, 0.0F);
  imaginary_.assign(points * kLists, 0.0F);
  next_real_.resize(points * kLists);
  next_imaginary_.resize(points * kLists);
  if (turned_ == points) return;
  turned_ = points;
  directions_.clear();
  for (std::size_t p = 0; p < std::max<std::size_t>(1, points / 2); ++p) {
    directions_.emplace_back(std::polar(1.0, kTwoPi * static_cast<double>(p) / static_cast<double>(points)));
  }
}

void ZeroPaddedInverseFft::Sum() {
  std::size_t block = kLists;
  for (std::size_t half = points_ / 2; half > 0; half /= 2, block *= 2) {
    if (block == kLists) {
      FirstPass(real_.data(), imaginary_.data(), next_real_.data(), next_imaginary_.data(),
                directions_.data(), half);
    } else {
      Pass(real_.data(), imaginary_.data(), next_real_.data(), next_imaginary_.data(), directions_.data(),
           half, block);
    }
    std::swap(real_, next_real_);
    std::swap(imaginary_, next_imaginary_);
  }
}

}  // namespace strainwave::analysis::diagnosis
