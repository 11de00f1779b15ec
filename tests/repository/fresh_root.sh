#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tries setup.sh as a new user would: on a bare Debian 12 in a folder, from a fresh clone.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tests/repository/fresh_root.sh [--cache DIR] [--folder DIR] [--working-tree] [--keep] [demo|test|both]

  --cache DIR       keep the downloaded packages here: a second run downloads nothing
  --folder DIR      where the root is made (default: a new folder under $TMPDIR or /tmp)
  --working-tree    try the files as they are now instead of a clone of HEAD
  --keep            do not remove the root at the end

Needs root, debootstrap, git and the network. The mirror is the one that apt on this machine uses.
Exit code: that of the first setup.sh that failed, else 0.
TEXT
}

fail() {
  echo "fresh_root.sh: error: $*" >&2
  exit 3
}

cache='' folder='' working_tree=0 keep=0 verbs=(demo test)
while (($# > 0)); do
  case $1 in
    --cache) cache=$(mkdir -p "$2" && readlink -f "$2") && shift ;;
    --folder) folder=$2 && shift ;;
    --working-tree) working_tree=1 ;;
    --keep) keep=1 ;;
    demo | test) verbs=("$1") ;;
    both) verbs=(demo test) ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && exit 2 ;;
  esac
  shift
done

((EUID == 0)) || fail "only root can make a root folder and change into it"
command -v debootstrap >/dev/null || fail "debootstrap is missing; run: apt-get install debootstrap"
repository=$(git -C "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" rev-parse --show-toplevel)
mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 'Identifier: Packages' |
         awk '$2 == "bookworm" {print $1; exit}')
[[ -n $mirror ]] || fail "apt on this machine has no source for bookworm"

folder=${folder:-$(mktemp -d "${TMPDIR:-/tmp}/fresh-root.XXXXXX")}
root=$folder/root
remove_root() {
  # Nothing is mounted here: the mounts lived in a namespace of their own and went with it.
  ((keep)) && echo "kept: $root" || rm -rf --one-file-system "$root"
}
trap remove_root EXIT
mkdir -p "$root"

make_root() {
  local options=(--variant=minbase)
  if [[ -n $cache ]]; then
    [[ -f $cache/base.tar.gz ]] ||
      debootstrap "${options[@]}" --make-tarball="$cache/base.tar.gz" bookworm "$folder/download" "$mirror"
    options+=(--unpack-tarball="$cache/base.tar.gz")
    mkdir -p "$cache/archives/partial"
  fi
  debootstrap "${options[@]}" bookworm "$root" "$mirror"
}

copy_repository() {
  if ((working_tree)); then
    mkdir -p "$root/root/strainwave"
    git -C "$repository" ls-files -z --cached --others --exclude-standard |
      tar -C "$repository" --null --files-from=- --ignore-failed-read -c |
      tar -C "$root/root/strainwave" --no-same-owner -x
  else
    git clone --quiet --no-local "$repository" "$root/root/strainwave"
  fi
}

# in_root COMMAND...: with an environment as bare as the root, and mounts that end with the command.
in_root() {
  CACHE=${cache:+$cache/archives} ROOT=$root unshare --mount --propagation private bash -c '
    set -e
    mount -t proc proc "$ROOT/proc"
    mount --rbind /dev "$ROOT/dev"
    if [[ -n $CACHE ]]; then mount --bind "$CACHE" "$ROOT/var/cache/apt/archives"; fi
    exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb chroot "$ROOT" "$@"' in_root "$@"
}

echo "making the root in $root"
make_root >"$folder/debootstrap.log" 2>&1 || fail "debootstrap failed, see $folder/debootstrap.log"
copy_repository

times=()
for verb in "${verbs[@]}"; do
  for run in first second; do
    [[ $run == second && $verb == test ]] && continue
    start=$SECONDS
    status=0
    in_root /root/strainwave/setup.sh "$verb" || status=$?
    times+=("$(printf '%-24s %5d s   exit %d' "setup.sh $verb ($run)" $((SECONDS - start)) "$status")")
    ((status == 0)) || break 2
  done
done
echo
source='downloaded'
if [[ -n $cache ]]; then source="from $cache where it had them"; fi
echo "bare Debian 12, $(nproc) cores, packages $source:"
printf '  %s\n' "${times[@]}"
exit "$status"
