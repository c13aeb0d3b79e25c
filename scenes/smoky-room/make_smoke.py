#!/usr/bin/env python3
"""Writes smoke.vol: wisps of smoke that rise through a room, as octaves of smoothed noise (always the same; needs numpy)."""
import os, struct
import numpy as np

SIZE = (48, 28, 48)  # x, y, z
rng = np.random.default_rng(7)


def octave(cells):
    """Noise on a coarse grid, made finer by cosine interpolation."""
    values = rng.random([c + 2 for c in cells])
    for axis, n in enumerate(SIZE):
        at = np.linspace(0, cells[axis], n)
        low = np.floor(at).astype(int)
        part = 0.5 - 0.5 * np.cos(np.pi * (at - low))
        shape = [1, 1, 1]
        shape[axis] = n
        part = part.reshape(shape)
        values = np.take(values, low, axis) * (1 - part) + np.take(values, low + 1, axis) * part
    return values


noise = sum(octave((3 * 2**k, 2 * 2**k, 3 * 2**k)) / 2**k for k in range(4)) / 1.875
height = np.linspace(0, 1, SIZE[1]).reshape(1, -1, 1)
# Gaps between the wisps, and more of them below the ceiling.
density = np.clip((noise - 0.44) * 6, 0, 1) * (0.25 + 0.75 * height)
path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "smoke.vol")
with open(path, "wb") as f:
    f.write(b"VOL\x03" + struct.pack("<5i6f", 1, *SIZE, 1, 0, 0, 0, 1, 1, 1))
    f.write(density.transpose(2, 1, 0).astype("<f4").tobytes())  # x fastest
print(f"{path}: mean {density.mean():.3f}, {100 * (density == 0).mean():.0f} % empty")
