#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The image of a file in memory, in HDF5 1.10.8.
# Packages: Debian libhdf5-103-1 1.10.8+repack1-1, python3-h5py-serial 3.7.0-8.
# Input: a file of one dataset in memory (core driver), flushed, with each lower bound of the format that h5py has.
# Guess: the bytes of H5Fget_file_image are the file, as it would be on disk after it is closed.
# What happens: so only in the oldest format. From superblock 2 on (v108, v110) the image cannot be opened: it differs from
#   the closed file in bytes 44 to 47 alone, the checksum of the superblock, which does not fit it.
#   A file written through a Python object (h5py.File(io.BytesIO(), "w")) and closed can be opened.
# Seen:
#   | earliest  superblock 0, opened
#   | v108      superblock 2, OSError: Unable to open file (incorrect metadata checksum after all read attempts)
#   |           bytes that differ from the closed file: 44, 45, 46, 47
#   | v110      superblock 3, OSError: Unable to open file (incorrect metadata checksum after all read attempts)
#   |           bytes that differ from the closed file: 44, 45, 46, 47
#   | BytesIO   superblock 3, opened
set -euo pipefail
source "$(dirname "$0")/packages.sh"
debian libhdf5-103-1=1.10.8+repack1-1 libhdf5-hl-100=1.10.8+repack1-1 liblzf1=3.6-3 \
  python3-h5py=3.7.0-8 python3-h5py-serial=3.7.0-8
python_modules h5py

cat >image.py <<'END'
import io

import h5py


def show(what, image):
    try:
        with h5py.File(io.BytesIO(image), "r") as file:
            said = "opened" if list(file["torque_Nm"]) == [1.0, 2.0] else "other values"
    except OSError as error:
        said = f"OSError: {error}"
    print(f"{what:9} superblock {image[8]}, {said}")


for bound in ("earliest", "v108", "v110"):
    with h5py.File(f"{bound}.h5", "w", driver="core", backing_store=True, libver=(bound, "v110")) as file:
        file["torque_Nm"] = [1.0, 2.0]
        file.flush()
        image = file.id.get_file_image()
    show(bound, image)
    closed = open(f"{bound}.h5", "rb").read()[:len(image)]
    different = [str(at) for at, (one, other) in enumerate(zip(image, closed)) if one != other]
    if different:
        print(f"{'':9} bytes that differ from the closed file: {', '.join(different)}")
memory = io.BytesIO()
with h5py.File(memory, "w", libver=("v110", "v110")) as file:
    file["torque_Nm"] = [1.0, 2.0]
show("BytesIO", memory.getvalue())
END
seen /usr/bin/python3 image.py
finish
