#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Two files in memory under one name, in HDF5 1.10.8.
# Packages: Debian libhdf5-103-1 1.10.8+repack1-1, python3-h5py-serial 3.7.0-8.
# Input: two files in memory (core driver, nothing on disk), one holds 1, the other 2; their images are opened for reading,
#   both under the name "image", as a program does that gets records over the network.
# Guess: a name of a file that is on no disk is a label; each image shows its own values.
# What happens: the second open gives the first image, without a word: the values of another record. A second new file of
#   the name is refused as open already ('w'). "./image" is another name for the library.
# Seen:
#   | two names        first 1.0  second 2.0
#   | one name         first 1.0  second 1.0
#   | 'w' again        OSError: Unable to create file (unable to truncate a file which is already open)
#   | 'w' as ./image   opened
set -euo pipefail
source "$(dirname "$0")/packages.sh"
debian libhdf5-103-1=1.10.8+repack1-1 libhdf5-hl-100=1.10.8+repack1-1 liblzf1=3.6-3 \
  python3-h5py=3.7.0-8 python3-h5py-serial=3.7.0-8
python_modules h5py

cat >image.py <<'END'
import h5py


def new(name):
    return h5py.File(name, "w", driver="core", backing_store=False)


def image_of(value):
    with new(f"made_{value}") as file:
        file["torque_Nm"] = [value]
        file.flush()
        return file.id.get_file_image()


def open_image(image, name):
    access = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    access.set_fapl_core(65536, False)
    access.set_file_image(image)
    return h5py.File(h5py.h5f.open(name, h5py.h5f.ACC_RDONLY, access))


def show(what, names):
    first, second = (open_image(image_of(value), name) for value, name in zip((1.0, 2.0), names))
    print(f"{what:16} first {first['torque_Nm'][0]}  second {second['torque_Nm'][0]}")
    second.close()
    first.close()


show("two names", (b"image", b"other"))
show("one name", (b"image", b"image"))
kept = new("image")
for what, name in (("'w' again", "image"), ("'w' as ./image", "./image")):
    try:
        new(name).close()
        print(f"{what:16} opened")
    except OSError as error:
        print(f"{what:16} OSError: {error}")
END
seen /usr/bin/python3 image.py
finish
