#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Vibration as sound files, through ffmpeg, SoX and flac.
# Packages: Debian ffmpeg 7:5.1.9-0+deb12u1, sox 14.4.2+git20190427-3.5, flac 1.4.2+ds-2.
# Input: 5000 samples with 24 bits of noise as FLAC, as recorders keep them; and accelerations of 0.5 to 34 m/s² as a WAV of
#   32-bit floats, which is not bound to full scale.
# Guess: from FLAC to WAV, both without loss, the samples stay; floats beyond full scale stay in a WAV, and FLAC, which has
#   whole numbers alone, refuses them.
# What happens: ffmpeg writes WAV with 16 bits whatever came in, and gives no warning of it: the samples are rounded,
#   floats are rounded and cut at full scale. Into FLAC it cuts them, too, without a word; SoX does it with a warning.
#   flac and SoX keep the 24 bits.
# Seen:
#   | 24 bits, FLAC to WAV    ffmpeg  16 bits, 21 of 5000 samples the same; said: nothing
#   | 24 bits, FLAC to WAV    sox     24 bits, 5000 of 5000 samples the same; said: nothing
#   | 24 bits, FLAC to WAV    flac    24 bits, 5000 of 5000 samples the same; said: nothing
#   | 24 bits, with pcm_s24le ffmpeg  24 bits, 5000 of 5000 samples the same; said: nothing
#   | 0.5 1.5 34.0 -34.0      ffmpeg  to WAV: 0.5 1.0 1.0 -1.0; said: nothing
#   | 0.5 1.5 34.0 -34.0      ffmpeg  to FLAC: 0.5 1.0 1.0 -1.0; said: nothing
#   | 0.5 1.5 34.0 -34.0      sox     to FLAC: 0.5 1.0 1.0 -1.0; said: clipped
set -euo pipefail
source "$(dirname "$0")/packages.sh"
installed ffmpeg=7:5.1.9-0+deb12u1 sox=14.4.2+git20190427-3.5 flac=1.4.2+ds-2

cat >bits.py <<'END'
import random
import struct
import subprocess
import wave

generator = random.Random(1)
NOISE = [generator.randrange(-2**23, 2**23) for _ in range(5000)]
FLOATS = [0.5, 1.5, 34.0, -34.0]


def packed(samples):
    return b"".join(struct.pack("<i", sample)[:3] for sample in samples)


def run(*command):
    """What a program says of lost bits or values."""
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return "clipped" if "clip" in done.stdout + done.stderr else "nothing"


def whole(path):
    """Bits of a sample, and the samples as shares of full scale, of a WAV of whole numbers."""
    with open(path, "rb") as file:
        data = file.read()
    at, bits = 12, 0
    while data[at:at + 4] != b"data":
        if data[at:at + 4] == b"fmt ":
            bits = struct.unpack_from("<H", data, at + 22)[0]
        at += 8 + struct.unpack_from("<I", data, at + 4)[0]
    size = bits // 8
    values = data[at + 8:]
    return bits, [int.from_bytes(values[i:i + size], "little", signed=True) / 2**(bits - 1) for i in range(0, len(values), size)]


with wave.open("noise.wav", "wb") as file:
    file.setparams((1, 3, 51200, 0, "NONE", ""))
    file.writeframes(packed(NOISE))
subprocess.run(["flac", "-s", "noise.wav", "-o", "noise.flac"], check=True)
values = struct.pack("<4f", *FLOATS)
with open("floats.wav", "wb") as file:
    file.write(b"RIFF" + struct.pack("<I", 50 + len(values)) + b"WAVEfmt " + struct.pack("<IHHIIHHH", 18, 3, 1, 1000, 4000, 4, 32, 0)
               + b"fact" + struct.pack("<II", 4, len(FLOATS)) + b"data" + struct.pack("<I", len(values)) + values)

FFMPEG = ("ffmpeg", "-nostdin", "-loglevel", "warning", "-y", "-i")
for what, name, command in (("FLAC to WAV", "ffmpeg", (*FFMPEG, "noise.flac", "out.wav")),
                            ("FLAC to WAV", "sox", ("sox", "noise.flac", "out.wav")),
                            ("FLAC to WAV", "flac", ("flac", "-s", "-f", "-d", "noise.flac", "-o", "out.wav")),
                            ("with pcm_s24le", "ffmpeg", (*FFMPEG, "noise.flac", "-c:a", "pcm_s24le", "out.wav"))):
    said = run(*command)
    bits, samples = whole("out.wav")
    same = sum(sample == noise / 2**23 for sample, noise in zip(samples, NOISE))
    print(f"{'24 bits, ' + what:23} {name:7} {bits} bits, {same} of {len(samples)} samples the same; said: {said}")
for name, target, command in (("ffmpeg", "WAV", (*FFMPEG, "floats.wav", "out.wav")),
                              ("ffmpeg", "FLAC", (*FFMPEG, "floats.wav", "out.flac")),
                              ("sox", "FLAC", ("sox", "floats.wav", "out.flac"))):
    said = run(*command)
    if target == "FLAC":
        subprocess.run(["flac", "-s", "-f", "-d", "out.flac", "-o", "out.wav"], check=True)
    shown = " ".join(f"{sample:.1f}" for sample in whole("out.wav")[1])
    print(f"{' '.join(map(str, FLOATS)):23} {name:7} to {target}: {shown}; said: {said}")
END
seen /usr/bin/python3 bits.py
finish
