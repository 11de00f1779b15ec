#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Records that h5py compressed with LZF, in a reader that has no LZF.
# Packages: Debian python3-h5py-serial 3.7.0-8, libhdf5-103-1 1.10.8+repack1-1; npm h5wasm 0.10.3 (HDF5 2.0.0); Node.js 20.20.2.
# Input: three records of 8192 doubles in chunks of 4096, all with compression="lzf": noise; noise and then 1.0, as of a
#   bench that stands still; 1.0 alone.
# Guess: a reader without LZF can read none of the three, and says so.
# What happens: noise does not become smaller, so h5py stores its chunks as they are, with a bit in the chunk's filter mask.
#   h5wasm reads that record in full, and a user takes LZF for supported. Of the other two it gives an array of the right
#   length without an exception, whose quiet rows are not what was stored: the library's error stands on stderr alone.
# Seen:
#   | noise        filter masks 1 1   compression lzf
#   | noise+quiet  filter masks 1 0   compression lzf
#   | quiet        filter masks 0 0   compression lzf
#   | noise        exception: no, rows 8192, as stored 8192
#   | noise+quiet  exception: no, rows 8192, as stored 4096
#   | quiet        exception: no, rows 8192, as stored 0
set -euo pipefail
source "$(dirname "$0")/packages.sh"
debian libhdf5-103-1=1.10.8+repack1-1 libhdf5-hl-100=1.10.8+repack1-1 liblzf1=3.6-3 \
  python3-h5py=3.7.0-8 python3-h5py-serial=3.7.0-8
python_modules h5py
npm_packages h5wasm@0.10.3

cat >write.py <<'END'
import h5py
import numpy as np

noise = np.random.default_rng(1).standard_normal(8192)
quiet = np.ones(8192)
with h5py.File("records.h5", "w") as file:
    for name, values in (("noise", noise), ("noise+quiet", np.r_[noise[:4096], quiet[:4096]]), ("quiet", quiet)):
        data = file.create_dataset(name, data=values, chunks=(4096,), compression="lzf")
        values.tofile(name)
        masks = [str(data.id.get_chunk_info(chunk).filter_mask) for chunk in range(data.id.get_num_chunks())]
        print(f"{name:12} filter masks {' '.join(masks)}   compression {data.compression}")
END
cat >read.mjs <<'END'
import fs from "fs";
import h5wasm from "h5wasm/node";

await h5wasm.ready;
const file = new h5wasm.File("records.h5", "r");
for (const name of ["noise", "noise+quiet", "quiet"]) {
  const stored = new Float64Array(new Uint8Array(fs.readFileSync(name)).buffer);
  let values = [];
  let thrown = "no";
  try {
    values = file.get(name).value;
  } catch (error) {
    thrown = error.message ?? error;
  }
  const same = Array.from(values).filter((value, row) => value === stored[row]).length;
  console.log(`${name.padEnd(12)} exception: ${thrown}, rows ${values.length}, as stored ${same}`);
}
file.close();
END
seen /usr/bin/python3 write.py
seen node read.mjs
finish
