#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# usage: tests/fuzz/run_all.sh [SECONDS]   every target in turn, 60 s each if not told otherwise, a line each; fails if
# one has a finding. The corpus of the tree stays as it is.
set -uo pipefail
cd "$(dirname "$0")"

failed=()
for target in fuzz_*.cc; do
  name=${target#fuzz_}
  name=${name%.cc}
  ./run.sh --check "$name" "${1:-60}" || failed+=("$name")
done
if ((${#failed[@]} > 0)); then
  echo "run_all.sh: error: ${#failed[@]} targets have findings: ${failed[*]} (expected none)" >&2
  exit 1
fi
