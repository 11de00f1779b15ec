#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# usage: tests/fuzz/run.sh [--check] NAME [SECONDS]   fuzzes tests/fuzz/fuzz_NAME.cc, 600 s if not told otherwise
#
# Builds it with the preset `fuzz`: clang's libFuzzer, address and undefined-behaviour sanitizers, in build-fuzz/. What
# it finds new is kept there; a small corpus that reaches the same edges replaces tests/fuzz/corpus/NAME.tar.xz at the
# end, but with --check. Lines in the head of a target: "// seeds:", files of the tree to begin with; "// longest:", bytes
# of an input, 4096 without it. The last line says executions, edges and findings; any finding is a failure.
set -euo pipefail
cd "$(dirname "$0")/../.."

check=0
if [[ ${1:-} == --check ]]; then
  check=1
  shift
fi
name=${1:?usage: tests/fuzz/run.sh [--check] NAME [SECONDS]}
seconds=${2:-600}
target=tests/fuzz/fuzz_$name.cc
build=$PWD/build-fuzz
packed=tests/fuzz/corpus/$name.tar.xz
[[ -f $target ]] || { echo "run.sh: error: there is no $target" >&2; exit 2; }
command -v clang++-14 >/dev/null || { echo "run.sh: error: clang++-14 is missing (packages clang-14, libclang-rt-14-dev)" >&2; exit 3; }

# What such a line of the head says.
head_of() { sed -n "s|^// $1: ||p" "$target" | paste -sd ' '; }
longest=$(head_of longest)
longest=${longest:-4096}

[[ -f $build/build.ninja ]] || cmake --preset fuzz --log-level=WARNING >/dev/null
cmake --build --preset fuzz --parallel "${STRAINWAVE_FUZZ_JOBS:-$(nproc)}" --target "fuzz_$name" >"$build/build_$name.txt" ||
  { cat "$build/build_$name.txt" >&2; exit 3; }

found=$build/found/$name  # what this and earlier runs have found new
kept=$build/kept/$name    # what the tree has
log=$build/$name.txt
rm -rf "$kept"
mkdir -p "$kept" "$found"
[[ ! -f $packed ]] || tar --extract --xz --directory "$kept" --file "$packed"
shopt -s nullglob
for seed in $(head_of seeds); do
  cp "$seed" "$kept/seed_$(basename "$seed")"
done
rm -f "$build/$name"-*

code=0
"$build/fuzz_$name" -max_total_time="$seconds" -max_len="$longest" -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 -print_funcs=0 \
  -artifact_prefix="$build/$name-" "$found" "$kept" >"$log" 2>&1 || code=$?
executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -n 1)
findings=("$build/$name"-{crash,leak,oom,timeout}-*)
echo "$name: ${executions:-0} executions, ${edges:-0} edges, ${#findings[@]} findings"
if ((code != 0 || ${#findings[@]} > 0)); then
  tail -n 60 "$log" >&2
  echo "run.sh: $name has ended with $code; its input: ${findings[*]:-none}" >&2
  exit 1
fi
((check == 0)) || exit 0

merged=$build/merged/$name
rm -rf "$merged"
mkdir -p "$merged" "$(dirname "$packed")"
"$build/fuzz_$name" -merge=1 -set_cover_merge=1 -use_counters=0 -max_len="$longest" -timeout=10 "$merged" "$kept" "$found" >"$log.merge" 2>&1
# The same inputs are the same archive.
XZ_OPT='-9 --threads=1' tar --create --xz --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=a=r,u+w \
  --format=ustar --directory "$merged" --file "$packed" $(cd "$merged" && LC_ALL=C ls)
rm -rf "$found"
