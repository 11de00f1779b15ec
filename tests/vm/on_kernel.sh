#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a test where the kernel has what it needs: here, or else in the virtual machine.
# Usage: on_kernel.sh IMAGE_FOLDER PART[,PART]... COMMAND [ARGUMENT]...
# A part is a network interface that is up (vcan0), uhid, or a module that is loaded (vivid). Exit code:
# the command's; 77 where neither can be had, with the reason.
set -euo pipefail

here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
image=$1
IFS=, read -ra parts <<<"$2"
shift 2
has() {
  case $1 in
    vcan*) [[ $(cat "/sys/class/net/$1/flags" 2>/dev/null) == 0x*[13579bdf] ]] ;;
    uhid) [[ -w /dev/uhid ]] ;;
    *) [[ -d /sys/module/$1 ]] ;;
  esac
}
for part in "${parts[@]}"; do
  if [[ $part == vcan* ]] && ! command -v candump >/dev/null; then
    echo "on_kernel.sh: can-utils are missing (expected the packages of setup.sh)"
    exit 77
  fi
done
for part in "${parts[@]}"; do
  if ! has "$part"; then
    echo "on_kernel.sh: no $part here, so in the virtual machine"
    exec "$here/run.sh" --image "$image" "$@"
  fi
done
echo "on_kernel.sh: ${parts[*]} are here, so natively"
exec "$@"
