#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# usage: tests/fuzz/run.sh NAME [SECONDS]   fuzzes tests/fuzz/fuzz_NAME.cc, 600 s if not told otherwise
#
# Builds it with clang's libFuzzer, address and undefined-behaviour sanitizers in build-fuzz/. What it finds new is
# kept there; a small corpus that reaches the same edges replaces tests/fuzz/corpus/NAME at the end. The sources,
# pkg-config libraries and further flags of a target are in its own lines "// sources:", "// libraries:", "// flags:".
set -euo pipefail
cd "$(dirname "$0")/../.."

name=${1:?usage: tests/fuzz/run.sh NAME [SECONDS]}
seconds=${2:-600}
target=tests/fuzz/fuzz_$name.cc
build=build-fuzz
kept=tests/fuzz/corpus/$name
clang=$(command -v clang++-14) || { echo "run.sh: error: clang++-14 is missing (packages clang-14, libclang-rt-14-dev)" >&2; exit 3; }

# Words of such lines, on one line.
words_of() { sed -n "s|^// $1:||p" "$target" | paste -sd ' '; }
read -ra sources <<<"$(words_of sources)"
read -ra libraries <<<"$(words_of libraries)"
read -ra flags <<<"$(pkg-config --cflags --libs "${libraries[@]}") $(words_of flags)"
mkdir -p "$build/$name" "$kept"
"$clang" -std=c++20 -O1 -g -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined \
  -isystem /usr/include/hdf5/serial -DSTRAINWAVE_VERSION='"fuzz"' -I. "$target" "${sources[@]}" "${flags[@]}" -o "$build/fuzz_$name"
"$build/fuzz_$name" -max_total_time="$seconds" -max_len=4096 -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 \
  -artifact_prefix="$build/$name-" "$build/$name" "$kept"
mkdir "$build/$name.merged"
"$build/fuzz_$name" -merge=1 -set_cover_merge=1 -use_counters=0 -max_len=4096 "$build/$name.merged" "$kept" "$build/$name"
rm -rf "${kept:?}" && mv "$build/$name.merged" "$kept"
