#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a command in a virtual machine with vcan0, vcan1, /dev/uhid and /dev/hidraw*: the host's files, folder and
# environment, but what is written stays there and is gone afterwards. Everything is slower than outside, so build
# outside. Time there goes by instructions, not by the host's clock: nothing that holds the host up is seen there.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: run.sh [--image FOLDER] [--write FOLDER]... [--mips N] COMMAND [ARGUMENT]...

  --image   where build_image.sh puts its files (build/vm)
  --write   what the command writes below this folder is written on the host
  --mips    million instructions that a second there has: 1000, 500 (without it), 250 or 125

Output is shown when the command has ended. Exit code: the command's; 77 without a virtual machine, with the reason;
125 when the machine gives no answer within VM_SECONDS (300) of the host's time.
TEXT
}

here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
image=$here/../../build/vm
shares=()
tags=""
shift_of_mips=1
while (($# > 0)); do
  case $1 in
    --image) image=$2; shift 2 ;;
    --write)
      folder=$(readlink -f "$2")
      tags+="w${#shares[@]}:$folder "
      shares+=(-virtfs "local,path=$folder,mount_tag=w${#shares[@]},security_model=none,multidevs=remap")
      shift 2
      ;;
    --mips)
      case $2 in
        1000) shift_of_mips=0 ;; 500) shift_of_mips=1 ;; 250) shift_of_mips=2 ;; 125) shift_of_mips=3 ;;
        *) usage >&2; exit 2 ;;
      esac
      shift 2
      ;;
    -h | --help) usage; exit 0 ;;
    *) break ;;
  esac
done
(($# > 0)) || { usage >&2; exit 2; }
"$here/build_image.sh" "$image"

control=$(mktemp -d)
trap 'rm -rf "$control"' EXIT
echo "$tags" >"$control/written"
date +%s >"$control/time"
{
  echo 'export STRAINWAVE_VM=1'
  declare -px | grep -vE '^declare -[a-z-]*x (OLDPWD|SHLVL|TMPDIR)\b' || true
  printf 'cd %q && exec' "$PWD"
  printf ' %q' "$@"
  echo
} >"$control/command"

# Emulated also where /dev/kvm can be opened: a machine within a machine may hang on it. An instruction takes 2^shift ns;
# where all there wait, time goes at once to the next moment at which one of them does not. Without the last two words
# for the kernel it holds real-time threads up, too: 3 ms every 10 s.
timeout "${VM_SECONDS:-300}" qemu-system-x86_64 -machine q35 -accel tcg,tb-size=256 -cpu max,la57=off -smp 1 -m 2G \
  -icount "shift=$shift_of_mips,sleep=off" \
  -nodefaults -no-user-config -display none -nic none -no-reboot -serial "file:$control/console" \
  -kernel "$image/vmlinuz" -initrd "$image/initramfs" \
  -append "console=ttyS0 quiet panic=-1 mitigations=off audit=0 tsc=reliable preempt=full transparent_hugepage=never" \
  -virtfs "local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap" \
  -virtfs "local,path=$control,mount_tag=control,security_model=none" \
  "${shares[@]}" -device virtio-rng-pci </dev/null >"$control/qemu" 2>&1 || true

for part in stdout stderr problems; do
  [[ ! -s $control/$part ]] && continue
  if [[ $part == stdout ]]; then cat "$control/$part"; else cat "$control/$part" >&2; fi
done
if [[ ! -s $control/status ]]; then
  echo "run.sh: the machine gave no answer; its last words:" >&2
  tail -n 20 "$control/qemu" "$control/console" >&2
  exit 125
fi
exit "$(cat "$control/status")"
