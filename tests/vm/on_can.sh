#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a test where there is a virtual CAN bus: here, if this kernel has vcan0 up, else in the virtual machine.
# Usage: on_can.sh IMAGE_FOLDER COMMAND [ARGUMENT]...; exit 77 where neither can be had, with the reason.
set -euo pipefail

here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
image=$1
shift
if [[ $(cat /sys/class/net/vcan0/flags 2>/dev/null) == 0x*[13579bdf] ]] && command -v candump >/dev/null; then
  exec "$@"
fi
command -v candump >/dev/null || { echo "on_can.sh: can-utils are missing (expected the packages of setup.sh)"; exit 77; }
echo "on_can.sh: no vcan0 here, so in the virtual machine"
exec "$here/run.sh" --image "$image" "$@"
