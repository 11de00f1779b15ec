#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# strainwave@.service under a systemd of its own: a container whose root is this machine's, with what is written kept aside.
# A cut is the container's whole process tree killed; its next start is the return of power. A shutdown is `poweroff` in it.
#
#   tests/packaging/service_under_systemd.sh BUILD     as root, with systemd-container; exit code 77 where that is missing
set -euo pipefail
build=$(realpath "$1")
checkout=$(realpath "$(dirname "$0")/../..")
if ((EUID != 0)) || ! command -v systemd-nspawn >/dev/null; then
  echo "skipped, because this needs root and Debian's systemd-container"
  exit 77
fi
if [[ ${IN_OWN_NAMESPACE:-} != yes ]]; then
  IN_OWN_NAMESPACE=yes exec unshare --mount "$0" "$@"
fi

work=$(mktemp -d)
leader=0
container=0
cleanup() {
  cut_power
  umount -R "$work" 2>/dev/null || true
  rmdir "$work"
}
trap cleanup EXIT
mount -t tmpfs tmpfs "$work"
mkdir "$work"/{upper,work,root}
mount -t overlay overlay -o "lowerdir=/,upperdir=$work/upper,workdir=$work/work" "$work/root"
root=$work/root
campaign=/var/lib/strainwave/first

fail() {
  echo "FAILED: $*" >&2
  [[ -n $leader ]] || exit 1
  inside systemctl status --no-pager -l strainwave@first >&2 || true
  inside journalctl --no-pager -u strainwave@first | tail -30 >&2 || true
  exit 1
}
# descendants PROCESS: those of it, a line each.
descendants() {
  local child
  for child in $(pgrep -P "$1"); do
    echo "$child"
    descendants "$child"
  done
}
boot() {
  # The container has a boot's id of its own, and so must have its own time since the boot.
  unshare --time --boottime "-$(cut -d. -f1 /proc/uptime)" --monotonic "-$(cut -d. -f1 /proc/uptime)" --fork systemd-nspawn --quiet --register=no --keep-unit -D "$root" -b systemd.unit=multi-user.target </dev/null >"$work/console" 2>&1 &
  container=$!
  local tries
  for ((tries = 0; tries < 600; ++tries)); do
    leader=$(descendants "$container" | xargs -r ps -o pid=,comm= -p | awk '$2 == "systemd" { print $1 }')
    if [[ -n $leader && $(inside systemctl is-system-running 2>/dev/null) =~ ^(running|degraded)$ ]]; then return; fi
    sleep 0.1
  done
  cat "$work/console" >&2
  fail "the container does not start"
}
cut_power() {
  if ((container != 0)); then
    kill -KILL "$leader" 2>/dev/null || true
    wait "$container" 2>/dev/null || true
  fi
  container=0
}
shut_down() {
  inside systemctl poweroff || fail "systemctl poweroff"
  wait "$container" 2>/dev/null || true
  container=0
}
inside() { nsenter -t "$leader" -m -u -i -n -p -T "$@"; }
# until WHAT COMMAND...: fails where that is not true within a minute.
until_true() {
  local what=$1 tries
  shift
  for ((tries = 0; tries < 600; ++tries)); do
    if "$@" >/dev/null 2>&1; then return; fi
    sleep 0.1
  done
  fail "$what"
}
status() { inside /usr/bin/strainwave status "$campaign" --json; }
runs() { [[ $(inside systemctl is-active strainwave@first) == active ]] && [[ $(status | sed -n 's/^ *"phase": "\(.*\)",/\1/p') != none ]]; }
restarts() { status | sed -n 's/^ *"unattended_restarts": \([0-9]*\),*/\1/p'; }
has_restarted() { [[ $(restarts) == "$1" ]]; }
expect_restarts() { has_restarted "$1" || fail "restarts: $(restarts), expected $1"; }
refused() { [[ $(inside systemctl show -P ExecMainStatus strainwave@first) == 2 && $(inside systemctl is-active strainwave@first) == failed ]]; }
main_process() { inside systemctl show -P MainPID strainwave@first; }

: >"$root/etc/machine-id"
DESTDIR=$root cmake --install "$build" --prefix /usr --component program >/dev/null
chroot "$root" systemd-sysusers strainwave.conf
mkdir -p "$root/var/lib/strainwave"
chroot "$root" chown strainwave: /var/lib/strainwave
sed 's/operator_acknowledges: true/operator_acknowledges: false\n  unattended: 3/' "$checkout/tests/simulation/small.yaml" >"$root/var/lib/strainwave/small.yaml"
mkdir -p "$root/etc/systemd/system/strainwave@.service.d"
printf '[Service]\n# Its own /proc, or /proc/sys, would show the boot of the machine and not of the container.\nProtectProc=default\nProtectKernelTunables=no\nProtectControlGroups=no\nWatchdogSec=2s\nTimeoutAbortSec=1s\nRestartSec=1s\n' >"$root/etc/systemd/system/strainwave@.service.d/soon.conf"
chroot "$root" systemctl disable mosquitto.service >/dev/null 2>&1 || true
order() { inside runuser -u strainwave -- /usr/bin/strainwave run "$@" --out "$campaign" --pace 1 --by-service; }

boot
order /var/lib/strainwave/small.yaml
inside systemctl enable --quiet strainwave@first
inside systemctl start strainwave@first || fail "systemctl start"
until_true "an ordered campaign begins" runs
expect_restarts 0
says_where_it_is() { [[ $(inside systemctl show -P StatusText strainwave@first) == *cycle* ]]; }
until_true "systemctl status says where it is" says_where_it_is
[[ $(inside stat -c %U "$campaign/campaign.db") == strainwave ]] || fail "its owner"
echo "ok: an ordered campaign runs; systemctl status shows '$(inside systemctl show -P StatusText strainwave@first)'"

inside kill -STOP "$(main_process)"
until_true "a run that hangs is killed and goes on" has_restarted 1
until_true "a run goes on after the watchdog" runs
inside journalctl --no-pager -u strainwave@first | grep -q "Watchdog timeout" || fail "no word of the watchdog"
echo "ok: a run that is stopped is ended by the watchdog and goes on, restart 1"

inside kill -KILL "$(main_process)"
until_true "a killed run goes on" has_restarted 2
until_true "a killed run goes on" runs
echo "ok: a run that is killed goes on, restart 2"

cut_power
boot
until_true "a run goes on when power returns" runs
expect_restarts 3
echo "ok: after a power cut it goes on by itself, restart 3"

cut_power
boot
until_true "the fourth time a person is asked" refused
expect_restarts 3
inside journalctl --no-pager -u strainwave@first -o cat | grep -F "it has done so 3 times" >/dev/null || fail "no reason"
echo "ok: the fourth time it asks for a person: $(inside journalctl --no-pager -u strainwave@first -o cat | grep -F 'without a person' | tail -1)"

order --resume
inside systemctl reset-failed strainwave@first
inside systemctl start strainwave@first || fail "systemctl start"
until_true "a person's order lets it go on" runs
expect_restarts 0
shut_down
boot
until_true "a run goes on after the machine was shut down" runs
expect_restarts 1
events() { inside sqlite3 -readonly "$campaign/campaign.db" "SELECT count(*) FROM events WHERE code = '$1'"; }
[[ $(events machine_shutdown) == 1 ]] || fail "the journal says nothing of the shutdown"
echo "ok: after an orderly shutdown of the machine it goes on, restart 1"

inside systemctl stop strainwave@first
[[ $(inside systemctl show -P Result strainwave@first) == success ]] || fail "the end of a stop"
shut_down
boot
until_true "after a stop a person is asked" refused
[[ $(events machine_shutdown) == 1 ]] || fail "a stop by a person is taken for a shutdown"
echo "ok: after systemctl stop, a shutdown and a start of the machine it stands"
chroot "$root" /usr/bin/strainwave verify "$campaign" >/dev/null || fail "verify"
echo "ok: the campaign is whole"
