#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the tests that a list has, each where the kernel has what it needs: here, or else all others one after the other
# in one virtual machine, which takes as long to start as some of them run.
# Usage: kernel_tests.sh IMAGE_FOLDER LIST [NAME]...     NAME: these alone
# LIST is read by this shell and calls: kernel_test NAME PART[,PART]... COMMAND [ARGUMENT]...
# A part is a network interface that is up (vcan0), uhid, or a module that is loaded (vivid). Exit code: 1 where one of
# them failed; 77 where none did, but some could be run nowhere, with the reason.
set -euo pipefail

here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
image=$1
list=$2
shift 2
wanted=" $* "
in_machine=()
failed=()
skipped=()

has() {
  case $1 in
    vcan*) [[ $(cat "/sys/class/net/$1/flags" 2>/dev/null) == 0x*[13579bdf] ]] ;;
    uhid) [[ -w /dev/uhid ]] ;;
    *) [[ -d /sys/module/$1 ]] ;;
  esac
}

has_all() {
  local part
  for part in ${1//,/ }; do
    has "$part" || return 1
  done
}

kernel_test() {
  local name=$1 parts=$2 code=0
  shift 2
  [[ $wanted == "  " || $wanted == *" $name "* ]] || return 0
  if [[ ! -v STRAINWAVE_VM ]] && ! has_all "$parts"; then
    in_machine+=("$name")
    return 0
  fi
  echo "== $name, where the kernel has $parts"
  "$@" || code=$?
  echo "== $name: exit code $code, $(cut -d ' ' -f 1 /proc/uptime) s after the start of the machine"
  case $code in
    0) ;;
    77) skipped+=("$name") ;;
    *) failed+=("$name") ;;
  esac
}

if ! command -v candump >/dev/null; then
  echo "kernel_tests.sh: can-utils are missing (expected the packages of setup.sh)"
  exit 77
fi
# shellcheck source=/dev/null
source "$list"
if ((${#in_machine[@]} > 0)); then
  echo "kernel_tests.sh: not of this kernel, so in the virtual machine: ${in_machine[*]}"
  code=0
  "$here/run.sh" --image "$image" "$here/kernel_tests.sh" "$image" "$list" "${in_machine[@]}" || code=$?
  case $code in
    0) ;;
    77) skipped+=("${in_machine[@]}") ;;
    *) failed+=("those in the virtual machine") ;;
  esac
fi
if ((${#failed[@]} > 0)); then
  echo "kernel_tests.sh: failed: ${failed[*]}"
  exit 1
fi
if ((${#skipped[@]} > 0)); then
  echo "kernel_tests.sh: skipped: ${skipped[*]}"
  exit 77
fi
