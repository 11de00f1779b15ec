// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Before the definition of a function whose loops the compiler turns into vectors by itself: compiled once
/// for each width of them, the widest that the machine has is taken when the program starts. Its file is one
/// of `strainwave_vector_loops` (cmake/strainwave.cmake), where nothing is contracted, and the additions of
/// each result keep their order: every machine gives the same bits. Loops that need registers counted or
/// lanes moved are written with Highway (docs/decisions/0018-vectors.md). Not with sanitizers: they start
/// later than the choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define STRAINWAVE_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define STRAINWAVE_VECTOR_CLONES
#endif

namespace strainwave::analysis {

/// Four numbers that the compiler keeps in as many registers as the machine needs for them. Never an argument
/// or a result of a function: how they would be passed depends on the machine.
using FourLanes = double __attribute__((vector_size(32), aligned(8), may_alias));
inline constexpr int kFourLanes = 4;

}  // namespace strainwave::analysis
