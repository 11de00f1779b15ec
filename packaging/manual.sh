#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Writes a manual page of each command of a program, and of programs beside it, from what --help says there.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: packaging/manual.sh FOLDER VERSION PROGRAM [OTHER...]

Writes FOLDER/PROGRAM-COMMAND.1 for every command that `PROGRAM --help` lists, and for commands of commands, and
FOLDER/OTHER.1; where a command and another program come to one name, one page tells of both. Nothing else stays in FOLDER.
Exit code 1, and FOLDER as it was, where a program fails or its help is not laid out as CLI11 does it.
TEXT
}

fail() {
  echo "manual.sh: error: $*" >&2
  exit 1
}

if (($# < 3)); then
  usage >&2
  exit 2
fi
script=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/manual.awk
folder=$1 version=$2 program=$3
shift 3
texts=$(mktemp -d)
trap 'rm -rf "$texts"' EXIT
mkdir "$texts/help"
# The columns of --help are counted in bytes.
export LC_ALL=C

# read_help PROGRAM [COMMAND...]: its help and that of all commands below, each in a file called as a person calls it.
read_help() {
  local code=0 words=${1##*/}${2:+ ${*:2}} commands command
  "$@" --help >"$texts/help/$words" 2>"$texts/said" </dev/null || code=$?
  ((code == 0)) || fail "'$words --help' ended with exit code $code (expected 0): $(cat "$texts/said")"
  [[ -s $texts/help/$words ]] || fail "'$words --help' says nothing"
  mapfile -t commands < <(sed -nE '1,/^Subcommands:$/d; s/^  ([a-z-]+)( .*)?$/\1/p' "$texts/help/$words")
  for command in "${commands[@]}"; do
    read_help "$@" "$command"
  done
}

read_help "$program"
name=${program##*/}
# Of the program as a whole there is a page already.
rm "$texts/help/$name"
[[ -n $(ls "$texts/help") ]] || fail "'$name --help' lists no commands (expected some below 'Subcommands:')"
for other in "$@"; do
  read_help "$other"
done

cd "$texts/help"
declare -A parts=()
pages=()
# Sorted: a command comes before a program of the same name, as ' ' comes before '-'.
for words in *; do
  page=${words// /-}
  [[ -v parts[$page] ]] || pages+=("$page")
  parts[$page]+=$words$'\n'
done
mkdir "$texts/pages"
for page in "${pages[@]}"; do
  mapfile -t files <<<"${parts[$page]%$'\n'}"
  awk -v page="$page" -v version="$version" -v name="$name" -v pages="${pages[*]}" -f "$script" "${files[@]}" \
    >"$texts/pages/$page.1"
done
cd "$OLDPWD"
rm -rf "$folder"
mkdir -p "$(dirname "$folder")"
cp -r "$texts/pages" "$folder"
