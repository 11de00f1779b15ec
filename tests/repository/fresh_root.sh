#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tries setup.sh, or the packages that it makes, as a new user would: on a bare Debian 12 in a folder, from a fresh clone.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tests/repository/fresh_root.sh [--cache DIR] [--folder DIR] [--working-tree] [--keep] [demo|test|both|package]

  --cache DIR       keep the downloaded packages here: a second run downloads nothing
  --folder DIR      where the root is made (default: a new folder under $TMPDIR or /tmp)
  --working-tree    try the files as they are now instead of a clone of HEAD
  --keep            do not remove the root at the end
  package           install the packages that `./setup.sh package` has made here, without a source tree, and run the
                    demo's campaign as a user of that machine

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
    package) verbs=(package) ;;
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

# timed WHAT COMMAND...: in the root, where nothing has failed so far; a row of the table, and the status of all.
times=() status=0
timed() {
  ((status == 0)) || return 0
  local what=$1 start=$SECONDS
  shift
  in_root "$@" || status=$?
  times+=("$(printf '%-24s %5d s   exit %d' "$what" $((SECONDS - start)) "$status")")
}

try_setup() {
  copy_repository
  local verb
  for verb in "${verbs[@]}"; do
    timed "setup.sh $verb (first)" /root/strainwave/setup.sh "$verb"
    if [[ $verb != test ]]; then
      timed "setup.sh $verb (second)" /root/strainwave/setup.sh "$verb"
    fi
  done
}

try_packages() {
  mkdir "$root/packages"
  cp "$repository"/build/packages/strainwave_*.deb "$root/packages" ||
    fail "there are no packages (expected those of ./setup.sh package)"
  in_root useradd --create-home user
  in_root apt-get -qq update
  timed 'install the package' env DEBIAN_FRONTEND=noninteractive sh -c \
    'apt-get -qq -o Dpkg::Use-Pty=0 install --no-install-recommends --yes /packages/*.deb gnuplot-nox >/dev/null'
  timed "the demo's campaign" runuser -u user -- sh -c \
    'cd && strainwave --version && strainwave run /usr/share/strainwave/schedules/quick.yaml --out first'
}

echo "making the root in $root"
make_root >"$folder/debootstrap.log" 2>&1 || fail "debootstrap failed, see $folder/debootstrap.log"
if [[ ${verbs[0]} == package ]]; then
  try_packages
else
  try_setup
fi
echo
source='downloaded'
if [[ -n $cache ]]; then source="from $cache where it had them"; fi
echo "bare Debian 12, $(nproc) cores, packages $source:"
printf '  %s\n' "${times[@]}"
exit "$status"
