#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# An array of three dimensions from SciPy's savemat, in mat-for-js.
# Packages: Debian python3-scipy 1.10.1-2; npm mat-for-js 1.1.0, Node.js 20.20.2.
# Input: loops[cycle][direction][sample] of 2 x 3 x 2 numbers 0 to 11, and the plain matrix of 2 x 3 numbers 0 to 5.
# Guess: both arrive as nested lists in the order of their indices.
# What happens: the matrix does. The array has the right shape, but its numbers stand in wrong places, some (4, 8, 10)
#   twice and others (5, 9, 11) never: without an exception.
# Seen:
#   | matrix  SciPy       [[0,1,2],[3,4,5]]
#   | loops   SciPy       [[[0,1],[2,3],[4,5]],[[6,7],[8,9],[10,11]]]
#   | matrix  mat-for-js  [[0,1,2],[3,4,5]]
#   | loops   mat-for-js  [[[0,8],[2,10],[4,7]],[[6,4],[8,1],[10,3]]]
set -euo pipefail
source "$(dirname "$0")/packages.sh"
debian python3-scipy=1.10.1-2
python_modules numpy scipy.io
npm_packages mat-for-js@1.1.0

cat >write.py <<'END'
import json

import numpy as np
import scipy.io

arrays = {"matrix": np.arange(6.0).reshape(2, 3), "loops": np.arange(12.0).reshape(2, 3, 2)}
scipy.io.savemat("arrays.mat", arrays)
read = scipy.io.loadmat("arrays.mat")
for name in arrays:
    print(f"{name:7} SciPy       {json.dumps(read[name].astype(int).tolist(), separators=(',', ':'))}")
END
cat >read.mjs <<'END'
import fs from "fs";
import {read} from "mat-for-js";

const {data} = read(new Uint8Array(fs.readFileSync("arrays.mat")).buffer);
for (const name of ["matrix", "loops"]) console.log(`${name.padEnd(7)} mat-for-js  ${JSON.stringify(data[name])}`);
END
seen /usr/bin/python3 write.py
seen node read.mjs
finish
