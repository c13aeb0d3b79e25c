"""Mitsuba 3's block means of the scenes here: `python3 make.py NAME [TIMES [FILE]]` writes `NAME.txt`: `veil`, `gallery 4`, and
`built 4 DIR/scene.xml` of what the example 06_write_a_scene writes.

4 x 4 blocks of the image, row by row: mean (r, g, b) and its standard error (r, g, b) over independent renderings.
"""
import os
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
HERE = os.path.dirname(os.path.abspath(__file__))
RUNS, SPP, GRID = 48, 64, 4  # SPP: times the second argument


def main(name, times=1, file=None):
    os.chdir(HERE)
    scene = mi.load_file(file or name + ".xml")
    runs = []
    for seed in range(RUNS):
        image = np.array(mi.render(scene, spp=SPP * int(times), seed=seed), dtype=np.float64)
        n = image.shape[0] // GRID
        runs.append(image.reshape(GRID, n, GRID, n, 3).mean((1, 3)).reshape(GRID * GRID, 3))
    runs = np.array(runs)
    mean, error = runs.mean(0), runs.std(0, ddof=1) / np.sqrt(RUNS)
    with open(name + ".txt", "w") as out:
        out.write(f"# mitsuba {mi.__version__}, scalar_rgb, {RUNS} x {SPP * int(times)} samples a pixel; written by make.py\n")
        for m, e in zip(mean, error):
            out.write(" ".join(f"{x:.7g}" for x in [*m, *e]) + "\n")


main(*sys.argv[1:])
