# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# For the scripts of this folder: a temporary folder that is gone at the end, pinned packages in it, and the comparison
# of what is seen with the lines "#   | " in the head of the script.

export PYTHONDONTWRITEBYTECODE=1 LC_ALL=C.UTF-8
temp=$(mktemp -d)
trap 'rm -rf "$temp"' EXIT
cd "$temp" || exit 1
script=$(realpath -- "$OLDPWD/$0" 2>/dev/null || realpath -- "$0")

cannot_run() {
  echo "cannot run: $1" >&2
  exit 77
}

# debian NAME=VERSION...: as installed, or else unpacked into the temporary folder.
debian() {
  local wanted name
  mkdir -p "$temp/root" "$temp/packages"
  for wanted in "$@"; do
    name=${wanted%%=*}
    if [ "$(dpkg-query -W -f '${Version}' "$name" 2>/dev/null)" = "${wanted#*=}" ]; then continue; fi
    (cd "$temp/packages" && apt-get download -qq "$wanted" >/dev/null 2>"$temp/apt.log") ||
      cannot_run "no Debian package $wanted (Debian 12, after apt-get update): $(tail -n 1 "$temp/apt.log")"
    dpkg -x "$temp/packages/${name}"_*.deb "$temp/root"
  done
  export PYTHONPATH="$temp/root/usr/lib/python3/dist-packages"
  export PATH="$temp/root/usr/bin:$PATH"
  LD_LIBRARY_PATH="$temp/root/usr/lib/$(uname -m)-linux-gnu:$temp/root/usr/lib/$(uname -m)-linux-gnu/hdf5/serial"
  export LD_LIBRARY_PATH
}

# installed NAME=VERSION...: of what needs too many other packages to be unpacked.
installed() {
  local wanted name
  for wanted in "$@"; do
    name=${wanted%%=*}
    [ "$(dpkg-query -W -f '${Version}' "$name" 2>/dev/null)" = "${wanted#*=}" ] ||
      cannot_run "$name ${wanted#*=} is not installed (apt-get install --no-install-recommends $wanted)"
  done
}

# python_modules NAME...: they and what they need can be imported.
python_modules() {
  local name
  for name in "$@"; do
    /usr/bin/python3 -c "import $name" 2>"$temp/import.log" ||
      cannot_run "/usr/bin/python3 does not import $name: $(tail -n 1 "$temp/import.log")"
  done
}

# npm_packages NAME@VERSION...
npm_packages() {
  command -v npm >/dev/null || cannot_run "npm is missing (expected Node.js 18 or newer)"
  echo '{"private": true}' >package.json
  npm install --cache="$temp/npm" --loglevel=error --no-audit --no-fund --ignore-scripts "$@" >npm.log 2>&1 ||
    cannot_run "no npm packages $*: $(grep -m 1 error npm.log)"
}

# seen PROGRAM ARGUMENT...: what it prints is added to what was seen, and how it fails, where it does.
seen() {
  "$@" 2>"$temp/error" | tee -a "$temp/seen" || echo "$1 failed: $(tail -n 1 "$temp/error")" | tee -a "$temp/seen"
}

finish() {
  sed -n 's/^#   | //p' "$script" >"$temp/expected"
  if diff "$temp/expected" "$temp/seen" >"$temp/changed"; then
    echo "as described"
  else
    echo "the behaviour has changed (< described, > seen):"
    cat "$temp/changed"
    exit 1
  fi
}
