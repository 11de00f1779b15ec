#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a schedule in the virtual machine over vcan, Modbus TCP, TCP streams and a uhid pendant, and on the embedded
# bench, same specimen; prints the results side by side (compare_campaigns.py).
# Usage: against_embedded.sh BUILD SCHEDULE FOLDER [MINUTES [OPTION...]]; FOLDER is emptied; after MINUTES (40) of the
# machine's time the cycle under way is the last one; OPTIONs are compare_campaigns.py's. How far it is: FOLDER/run.txt;
# a file FOLDER/finish ends it as MINUTES do. Exit code 77 without a virtual machine, 1 where the results do not agree.
set -euo pipefail

(($# >= 3)) || { sed -n 3,7p "$0" >&2; exit 2; }
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
build=$(readlink -f "$1")
schedule=$(readlink -f "$2")
minutes=${4:-40}
rm -rf "$3"
mkdir -p "$3"
folder=$(readlink -f "$3")

code=0
VM_SECONDS=${VM_SECONDS:-86400} "$here/run.sh" --image "$build/vm" --write "$folder" \
  /usr/bin/python3 -B "$here/campaign.py" "$build" "$schedule" "$folder" --minutes "$minutes" || code=$?
((code != 77)) || exit 77
# 130: ended after a cycle, as it was asked to.
((code == 0 || code == 130)) || { echo "against_embedded.sh: the campaign in the machine ended with $code"; exit 1; }
"$build/strainwave" run "$schedule" --out "$folder/embedded" >"$folder/embedded.txt" 2>&1
shift $(($# < 4 ? $# : 4))
"$here/compare_campaigns.py" "$folder/campaign" "$folder/embedded" "$@"
