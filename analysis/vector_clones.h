// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Before the definition of a function: compiled once for each width of vectors, the widest that the machine
/// has is taken when the program starts. The additions of each result keep their order and nothing is
/// contracted, so every machine gives the same bits. Not with sanitizers: they start later than the choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define STRAINWAVE_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
/// The same without the widest: for loops that need other code there (`HasWideVectors`).
#define STRAINWAVE_HALF_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
/// Compiled for the widest alone; call it only where `HasWideVectors`.
#define STRAINWAVE_WIDE_VECTORS __attribute__((target("avx512f")))
#else
#define STRAINWAVE_VECTOR_CLONES
#define STRAINWAVE_HALF_VECTOR_CLONES
#define STRAINWAVE_WIDE_VECTORS
#endif

namespace strainwave::analysis {

/// Eight numbers that the compiler keeps in as many registers as the machine needs for them. Never an
/// argument or a result of a function: how they would be passed depends on the machine.
using Lanes = double __attribute__((vector_size(64), aligned(8), may_alias));
inline constexpr int kLanes = 8;

/// Half of them: what the registers of a machine with AVX2 hold. g++ 12 takes sums of `Lanes` through memory
/// there, where many of them are kept at once.
using HalfLanes = double __attribute__((vector_size(32), aligned(8), may_alias));
inline constexpr int kHalfLanes = 4;

/// Whether registers hold `Lanes`, so that many of them fit into a loop.
inline bool HasWideVectors() {
#if defined(__x86_64__) && defined(__GNUC__)
  return __builtin_cpu_supports("avx512f") != 0;
#else
  return false;
#endif
}

}  // namespace strainwave::analysis
