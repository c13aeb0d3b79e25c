#!/usr/bin/env python3
"""Small reference images of the scenes in this folder, by Mitsuba 3: an independent renderer (pip install mitsuba numpy).

    scenes/make_references.py [--seconds 120] [--only NAME ...]

Writes per scene NAME/reference.exr (mean, box filter) and NAME/reference.stderr.exr (standard error of the mean, per pixel and
channel, over independent batches), which the tests compare with. Needs nothing of this project.
"""
import argparse, os, time
import numpy as np

SIZES = {"cornell-box": (48, 48), "corner": (48, 48), "ajar": (64, 36), "kitchen": (64, 36),
         "fruit-juice": (48, 48), "fog-corridor": (64, 36),
         "smoky-room": (64, 36)}
SPP = 512


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--seconds", type=float, default=120)
    arguments.add_argument("--only", nargs="*", choices=list(SIZES))
    arguments.add_argument("--variant", default="scalar_rgb")
    given = arguments.parse_args()
    import mitsuba as mi

    mi.set_variant(given.variant)
    here = os.path.dirname(os.path.abspath(__file__))
    for name in given.only or SIZES:
        width, height = SIZES[name]
        scene = mi.load_file(os.path.join(here, name, "scene.xml"), resx=width, resy=height)
        batches, mean, squares = 0, 0.0, 0.0
        start = time.time()
        while batches < 4 or time.time() - start < given.seconds:
            image = np.array(mi.render(scene, spp=SPP, seed=batches), dtype=np.float64)[..., :3]
            batches += 1
            delta = image - mean
            mean = mean + delta / batches
            squares = squares + delta * (image - mean)
        stderr = np.sqrt(squares / (batches - 1) / batches)
        for tag, pixels in (("reference", mean), ("reference.stderr", stderr)):
            mi.Bitmap(pixels.astype(np.float32)).write(os.path.join(here, name, tag + ".exr"))
        print(f"{name}: {batches} batches of {SPP} samples a pixel, mean {mean.mean((0, 1))}, "
              f"relative error of the mean {np.sqrt((stderr**2).sum((0, 1))) / stderr[..., 0].size / mean.mean((0, 1))}")


main()
