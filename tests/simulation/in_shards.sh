#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a GoogleTest program, or a script that knows its variables for shards, several times at once, each time with a
# share of its tests: for tests that wait in real time and compute little.
# Usage: in_shards.sh SHARDS PROGRAM [ARGUMENT...]. Exit code: 1 if one of them failed.
set -euo pipefail

shards=$1
shift
said=$(mktemp -d)
trap 'rm -rf "$said"' EXIT
for ((shard = 0; shard < shards; ++shard)); do
  GTEST_TOTAL_SHARDS=$shards GTEST_SHARD_INDEX=$shard "$@" >"$said/$shard" 2>&1 &
  processes[shard]=$!
done
code=0
for ((shard = 0; shard < shards; ++shard)); do
  wait "${processes[shard]}" || code=1
  cat "$said/$shard"
done
exit "$code"
