#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A small virtual machine's kernel and first file system, for tests that need what the host's kernel has not: CAN,
# uhid, and a camera. Debian's stock kernel is fetched once (about 70 MB, no root needed), and iiod.
set -euo pipefail

usage() { echo "usage: $0 FOLDER   makes FOLDER/vmlinuz and FOLDER/initramfs, unless they are there (exit 77: cannot)"; }

skip() {
  echo "build_image.sh: no virtual machine: $*" >&2
  exit 77
}

MODULES=(virtio_pci virtio_mmio 9pnet_virtio 9p overlay can can-raw can-dev vcan sch_netem hid uhid hid-generic
  hid-sensor-hub hid-sensor-accel-3d vivid)

(($# == 1)) || { usage >&2; exit 2; }
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
mkdir -p "$1"
cd "$1"
exec 9>lock
flock 9

# The first program is packed by itself, behind the modules, so that a change of it needs no kernel.
finish() {
  mkdir -p first
  install -m 755 "$here/init" first/init
  (cd first && echo init | cpio --create --format=newc --quiet) | cat modules.cpio - >initramfs.new
  mv initramfs.new initramfs
}
for tool in qemu-system-x86_64 busybox cpio depmod modprobe strip apt-get dpkg-deb; do
  command -v "$tool" >/dev/null || PATH=$PATH:/usr/sbin:/sbin command -v "$tool" >/dev/null ||
    skip "'$tool' is missing (expected the packages that setup.sh names)"
done
PATH=$PATH:/usr/sbin:/sbin
if [[ -s vmlinuz && modules.cpio -nt "$here/build_image.sh" ]]; then
  finish
  exit 0
fi

work=$(mktemp -d "$PWD/work.XXXXXX")
trap 'rm -rf "$work"' EXIT
package=$(apt-cache depends --important linux-image-amd64 2>/dev/null | awk '/Depends:/ {print $2; exit}')
[[ -n $package ]] || skip "apt knows no linux-image-amd64 (expected Debian 12 for amd64, and apt-get update)"
(cd "$work" && apt-get -qq -o APT::Sandbox::User=root download "$package" >&2) || skip "$package could not be fetched"
dpkg-deb --extract "$work"/"$package"_*.deb "$work/kernel"
release=$(basename "$work"/kernel/lib/modules/*)
depmod --basedir "$work/kernel" "$release"

root=$work/root
mkdir -p "$root"/{bin,modules,proc,sys,dev,control,host,scratch,system}
cp "$(command -v busybox)" "$root/bin/busybox"
for module in "${MODULES[@]}"; do
  # Each line: insmod PATH, in the order in which they go in; what is built in has none.
  modprobe --dirname "$work/kernel" --set-version "$release" --show-depends "$module" | awk '$1 == "insmod" {print $2}'
done | awk '!seen[$0]++' | while read -r path; do
  name=$(basename "$path")
  case $name in
    *.xz) xz --decompress --stdout "$path" >"$root/modules/${name%.xz}"; name=${name%.xz} ;;
    *) cp "$path" "$root/modules/$name" ;;
  esac
  strip --strip-debug "$root/modules/$name"
  echo "$name" >>"$root/modules/order"
done
# A peer for IIO devices. Installed, it would serve the user's own to the network from then on.
(cd "$work" && apt-get -qq -o APT::Sandbox::User=root download iiod >&2) && dpkg-deb --extract "$work"/iiod_*.deb iiod ||
  echo "build_image.sh: no iiod: the tests against it will be skipped" >&2
cp "$work"/kernel/boot/vmlinuz-* vmlinuz
(cd "$root" && find . -print0 | cpio --null --create --format=newc --quiet) >"$work/modules.cpio"
mv "$work/modules.cpio" modules.cpio
finish
