#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# HDF5 texts of fixed length with a fill value of their own, in netCDF.
# Packages: Debian netcdf-bin 1:4.9.0-3+b1, libnetcdf19 1:4.9.0-3+b1, python3-h5py-serial 3.7.0-8.
# Input: a dataset of 20 texts of three bytes, once without and once with a fill value.
# Guess: ncdump shows the header of both, as h5dump does.
# What happens: the fill value of fixed length is taken for a pointer to a text: ncdump dies of a segmentation fault, and with
#   it every program that opens the file through the library. HDF5's own fill is the same zeros, and harmless.
# Seen:
#   | no fill value: exit 0, string direction(phony_dim_0) ;
#   | fill value: exit 139, string direction(phony_dim_0) ;
set -euo pipefail
source "$(dirname "$0")/packages.sh"
debian netcdf-bin=1:4.9.0-3+b1 libnetcdf19=1:4.9.0-3+b1 libhdf5-103-1=1.10.8+repack1-1 libhdf5-hl-100=1.10.8+repack1-1 \
  python3-h5py=3.7.0-8 python3-h5py-serial=3.7.0-8
python_modules h5py

cat >both.py <<'END'
import h5py
import numpy
import subprocess

for title, more in (("no fill value", {}), ("fill value", {"fillvalue": b"x"})):
    with h5py.File("a.h5", "w") as file:
        file.create_dataset("direction", data=numpy.array([b"cw", b"ccw"] * 10, "S3"), chunks=(20,), **more)
    done = subprocess.run(["ncdump", "-h", "a.h5"], capture_output=True, text=True)
    words = [line.strip() for line in done.stdout.splitlines() if "string" in line]
    code = done.returncode if done.returncode >= 0 else 128 - done.returncode
    print(f"{title}: exit {code}, {' '.join(words)}".rstrip())
END
seen /usr/bin/python3 both.py
finish
