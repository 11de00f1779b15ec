#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The control loop on vcan0 beside cangen at more than half the load of a bus of 1 Mbit/s. vcan has no bit rate: a frame
# of 8 bytes under an identifier of 11 bits takes 111 bits where none are stuffed, so half of 1 Mbit/s is 4505 of them a
# second.
# Usage: run.sh bus_load.sh BUILD [SECONDS [PERIOD_MS...]]; the load that was really there is printed beside.
set -euo pipefail

(($# >= 1)) || { sed -n 3,6p "$0" >&2; exit 2; }
build=$1
seconds=${2:-60}
shift $(($# < 2 ? $# : 2))
carried() { cat /sys/class/net/vcan0/statistics/tx_packets; }

# Ten at a time, and faster than needed, as the control loop goes before it.
cangen vcan0 -g 1 -c 10 -I 555 -L 8 -D r -i &
trap 'kill $!' EXIT
for period in "${@:-10}"; do
  before=$(carried)
  from=$(date +%s.%N)
  "$build/benchmarks/control_loop_benchmark" "$seconds" "$period" vcan0
  echo "period $period ms: $(awk "BEGIN {print int(($(carried) - $before) / ($(date +%s.%N) - $from))}") frames/s on the bus in all"
done
