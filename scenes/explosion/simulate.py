#!/usr/bin/env python3
"""Writes temperature.vol and density.vol: a burst of fuel that burns, rises and rolls up into soot (always the same; needs numpy).

A small fluid solver on 48 x 64 x 48 cells: advection back along the velocity (trilinear), fuel that burns where it is hot and gives
heat, soot and expansion, cooling, buoyancy, vorticity confinement, and pressure by a Fourier transform (periodic: the box is large
enough for what happens in it). Temperatures are in units of which 1 is about 1800 K, density is soot.

  simulate.py                 the state of the scene file (step 26)
  simulate.py --frames DIR    every step from 6 to 41 as DIR/temperature_0001.vol .. and DIR/density_0001.vol ..
"""
import os, struct, sys
import numpy as np

SIZE = (48, 64, 48)  # x, y (up), z
STEP, CELL = 0.05, 1.0 / 48
KEPT, FIRST, LAST = 26, 6, 41
rng = np.random.default_rng(3)
grid = np.stack(np.meshgrid(*[np.arange(n, dtype=np.float32) for n in SIZE], indexing="ij"))


def smooth_noise(width):
    k2 = sum(np.fft.fftfreq(n).reshape([-1 if i == a else 1 for i in range(3)]) ** 2 for a, n in enumerate(SIZE))
    noise = np.fft.ifftn(np.fft.fftn(rng.standard_normal(SIZE)) * np.exp(-2 * (np.pi * width) ** 2 * k2)).real
    return (noise / noise.std()).astype(np.float32)


def sample(field, at):
    low = np.floor(at).astype(np.int32)
    part = at - low
    out = np.zeros(SIZE, np.float32)
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod([part[a] if corner[a] else 1 - part[a] for a in range(3)], axis=0)
        index = tuple(np.clip(low[a] + corner[a], 0, SIZE[a] - 1) for a in range(3))
        out += weight * field[index]
    return out


def gradient(field):
    return [(np.roll(field, -1, a) - np.roll(field, 1, a)) / 2 for a in range(3)]


# Eigenvalues of the Laplacian that central differences make.
waves = np.meshgrid(*[np.sin(2 * np.pi * np.fft.fftfreq(n)) for n in SIZE[:2]], np.sin(2 * np.pi * np.fft.rfftfreq(SIZE[2])), indexing="ij")
laplacian = -sum(w**2 for w in waves)
laplacian[np.abs(laplacian) < 1e-9] = np.inf


def write(folder, name, field):
    with open(os.path.join(folder, name), "wb") as f:
        f.write(b"VOL\x03" + struct.pack("<5i6f", 1, *SIZE, 1, 0, 0, 0, 1, 1, 1))
        f.write(field.transpose(2, 1, 0).astype("<f4").tobytes())  # x fastest


def soft(field, least):
    """Nothing below `least`, and no edge there."""
    return field * np.clip((field - least) / least, 0, 1)


frames = sys.argv[2] if len(sys.argv) == 3 and sys.argv[1] == "--frames" else None
here = os.path.dirname(os.path.abspath(__file__))
centre = np.array([24, 15, 24], np.float32).reshape(3, 1, 1, 1)
radius = np.sqrt(((grid - centre) ** 2).sum(0)) * (1 + 0.2 * smooth_noise(3))
fuel = (radius < 8).astype(np.float32)
heat = (radius < 5).astype(np.float32)
soot = np.zeros(SIZE, np.float32)
velocity = np.stack([0.25 * smooth_noise(4) * (radius < 9) for _ in range(3)])
for step in range(LAST + 1):
    burnt = np.minimum(fuel, (heat > 0.08) * 3 * STEP * (0.3 + heat) * fuel)
    fuel, heat, soot = fuel - burnt, heat + 1.9 * burnt, soot + burnt
    source = 1.5 * burnt / STEP
    heat = np.maximum(heat - STEP * (0.15 * heat + 0.3 * heat**3), 0)
    soot *= 1 - 0.02 * STEP
    velocity[1] += STEP * (1.5 * heat - 0.1 * soot)
    g = [gradient(v) for v in velocity]
    curl = np.stack([g[2][1] - g[1][2], g[0][2] - g[2][0], g[1][0] - g[0][1]])
    n = np.stack(gradient(np.sqrt((curl**2).sum(0))))
    n /= np.sqrt((n**2).sum(0)) + 1e-6
    velocity += STEP * 2.5 * np.cross(n, curl, axis=0) * (soot > 0.01)
    divergence = sum(gradient(velocity[a])[a] for a in range(3)) / CELL - source
    pressure = np.fft.irfftn(np.fft.rfftn(divergence - divergence.mean()) * CELL**2 / laplacian, SIZE, axes=(0, 1, 2))
    velocity = np.clip(velocity - np.stack(gradient(pressure)) / CELL, -6, 6).astype(np.float32)
    back = grid - STEP / CELL * velocity
    heat, soot, fuel = [sample(f, back) for f in (heat, soot, fuel)]
    velocity = np.stack([sample(v, back) for v in velocity])
    if frames and FIRST <= step:
        os.makedirs(frames, exist_ok=True)
        write(frames, f"temperature_{step - FIRST + 1:04}.vol", soft(heat, 0.02))
        write(frames, f"density_{step - FIRST + 1:04}.vol", soft(soot, 0.004))
    if not frames and step == KEPT:
        write(here, "temperature.vol", soft(heat, 0.02))
        write(here, "density.vol", soft(soot, 0.004))
        break
    print(f"step {step}: hottest {heat.max():.2f}, soot {soot.sum():.0f}, fastest {np.abs(velocity).max():.2f}", flush=True)
