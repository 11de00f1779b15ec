#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# usage: tests/safety_coverage.sh   branches of the safety layer (bench/SAFETY.md) that its own tests take
#
# Builds the layer and its tests alone, with clang's source-based coverage, in build-coverage/. Exit code 1 where a branch
# is not taken. Packages: clang-14, llvm-14, libclang-rt-14-dev.
set -euo pipefail
cd "$(dirname "$0")/.."

layer=(drive_watch interlocks set_point_watch shaft_watch state_machine)
clang=$(command -v clang++-14) || { echo "safety_coverage.sh: error: clang++-14 is missing (package clang-14)" >&2; exit 3; }
build=build-coverage
mkdir -p "$build"
sources=()
for name in "${layer[@]}"; do
  sources+=("bench/safety/$name.cc" "tests/bench/${name}_test.cc")
done
"$clang" -std=c++20 -O0 -g -fprofile-instr-generate -fcoverage-mapping -DFMT_SHARED -I. "${sources[@]}" \
  bench/safety/stop_reason.cc bench/safety/texts_apart.cc -lgtest -lgtest_main -lfmt -pthread -o "$build/safety_tests"
LLVM_PROFILE_FILE="$build/safety.profraw" "$build/safety_tests" --gtest_brief=1
llvm-profdata-14 merge -o "$build/safety.profdata" "$build/safety.profraw"
files=("${layer[@]/#/bench/safety/}")
files=("${files[@]/%/.cc}")
llvm-cov-14 report "$build/safety_tests" -instr-profile="$build/safety.profdata" --show-branch-summary "${files[@]}"
missed=$(llvm-cov-14 export "$build/safety_tests" -instr-profile="$build/safety.profdata" -summary-only "${files[@]}" |
  /usr/bin/python3 -c 'import json, sys; print(json.load(sys.stdin)["data"][0]["totals"]["branches"]["notcovered"])')
if ((missed > 0)); then
  echo "safety_coverage.sh: error: $missed branches are not taken (expected: none)" >&2
  exit 1
fi
