"""What Mitsuba 3 makes of the scenes here: `python3 make.py` writes `values.txt`, which `tests/oracle.rs` reads.

Each `NAME.xml` is a scene of one shape. For rays to it and directions from there: `eval` of its BSDF (with the cosine, radiance)
and what comes through in a straight line (`eval_null_transmission`). One line: name, origin, direction, out, value, through.
"""
import glob
import os

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
HERE = os.path.dirname(os.path.abspath(__file__))


def images():
    rng = np.random.default_rng(7)
    colours = (rng.random((5, 4, 3)) * 255).astype(np.uint8)
    mi.Bitmap(colours).write(os.path.join(HERE, "colours.png"))
    normals = rng.random((4, 4, 3)) * 0.5 + 0.25
    normals[:, :, 2] = 0.9
    mi.Bitmap((normals * 255).astype(np.uint8)).write(os.path.join(HERE, "normals.png"))


def directions(rng, n):
    w = rng.normal(size=(n, 3))
    return w / np.linalg.norm(w, axis=1)[:, None]


def rows(name, rng):
    scene = mi.load_file(os.path.join(HERE, name + ".xml"))
    context = mi.BSDFContext()
    found = 0
    while found < 24:
        target = rng.uniform(-0.7, 0.7, 3)
        target[2] = 0
        origin = target + directions(rng, 1)[0] * 3
        d = (target - origin) / np.linalg.norm(target - origin)
        if abs(d[2]) < 0.15:
            continue
        si = scene.ray_intersect(mi.Ray3f(list(origin), list(d)))
        if not si.is_valid():
            continue
        found += 1
        bsdf = si.bsdf()
        null = np.array(bsdf.eval_null_transmission(si))
        for w in directions(rng, 3):
            if abs(w[2]) < 0.1:
                continue
            value = np.array(bsdf.eval(context, si, si.to_local(mi.Vector3f(list(w)))))
            numbers = [*origin, *d, *w, *value, *null]
            yield name + " " + " ".join(f"{x:.8g}" for x in numbers)


def main():
    os.chdir(HERE)
    images()
    with open("values.txt", "w") as out:
        out.write(f"# mitsuba {mi.__version__}, scalar_rgb; written by make.py\n")
        for path in sorted(glob.glob("*.xml")):
            name = os.path.splitext(path)[0]
            seed = sum(ord(c) * (i + 1) for i, c in enumerate(name))
            for line in rows(name, np.random.default_rng(seed)):
                out.write(line + "\n")


main()
