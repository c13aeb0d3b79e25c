"""Prints f cos and the density of sampling of Mitsuba 3 (variant scalar_rgb) for every model with a smooth lobe, and the
weights of its delta lobes: what tests/mitsuba.rs compares with.

    python mitsuba_oracle.py > mitsuba_oracle.txt

Line: name | parameters | wi | wo | f cos (3) | pdf. For delta lobes: name | parameters | wi | wo | weight (3) | pdf | eta,
drawn with the lobe number 0 (reflection) or 0.999999 (refraction), in radiance mode.
"""

import math
import random

import mitsuba as mi

mi.set_variant("scalar_rgb")
random.seed(20240501)

DIFFUSE = [0.1, 0.5, 0.9]
SPECULAR = [1.0, 0.8, 0.3]
METALS = {"gold-like": ([0.14, 0.37, 1.44], [3.98, 2.39, 1.60]), "chromium-like": ([3.1, 3.2, 2.3], [3.3, 3.3, 3.1])}


def rgb(value):
    return {"type": "rgb", "value": list(value)}


def unit():
    z = random.random()
    phi = 2 * math.pi * random.random()
    r = math.sqrt(1 - z * z)
    return [r * math.cos(phi), r * math.sin(phi), z]


def numbers(values):
    return " ".join(f"{float(v):.9g}" for v in values)


def interaction(wi):
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(*wi)
    return si


def near_mirror(wi, alpha):
    """Where the lobe is: the mirrored direction, disturbed by a few alpha."""
    while True:
        m = [random.gauss(0, alpha), random.gauss(0, alpha), 1.0]
        norm = math.sqrt(sum(x * x for x in m))
        m = [x / norm for x in m]
        d = sum(a * b for a, b in zip(wi, m))
        wo = [2 * d * b - a for a, b in zip(wi, m)]
        if wo[2] > 0.01:
            return wo


def smooth(name, parameters, bsdf, alpha=None, count=24):
    bsdf = mi.load_dict(bsdf)
    context = mi.BSDFContext()
    for i in range(count):
        wi = unit() if i > 0 else [0.0, 0.0, 1.0]
        wo = near_mirror(wi, alpha) if alpha and i % 2 == 0 else unit()
        si = interaction(wi)
        value = bsdf.eval(context, si, mi.Vector3f(*wo))
        pdf = bsdf.pdf(context, si, mi.Vector3f(*wo))
        print(" | ".join([name, parameters, numbers(wi), numbers(wo), numbers(value), numbers([pdf])]))


def delta(name, parameters, bsdf, lobes, inside=False):
    bsdf = mi.load_dict(bsdf)
    context = mi.BSDFContext()
    for i in range(8):
        wi = unit() if i > 0 else [0.0, 0.0, 1.0]
        if inside and i % 2 == 0:
            wi[2] = -wi[2]
        for lobe in lobes:
            sample, weight = bsdf.sample(context, interaction(wi), lobe, mi.Point2f(0.5, 0.5))
            values = [numbers(wi), numbers(sample.wo), numbers(weight), numbers([sample.pdf]), numbers([sample.eta])]
            print(" | ".join([name, parameters, *values]))


smooth("diffuse", "-", {"type": "diffuse", "reflectance": rgb(DIFFUSE)}, count=8)

for metal, (eta, k) in METALS.items():
    ior = {"eta": rgb(eta), "k": rgb(k), "specular_reflectance": rgb(SPECULAR)}
    delta("conductor", numbers(eta + k), {"type": "conductor", **ior}, [0.5])
    for distribution in ["beckmann", "ggx"]:
        for alpha_u, alpha_v in [(0.1, 0.1), (0.5, 0.5), (0.05, 0.3), (0.9, 0.2)]:
            parameters = f"{distribution} {alpha_u} {alpha_v} " + numbers(eta + k)
            rough = {"type": "roughconductor", "distribution": distribution, "alpha_u": alpha_u, "alpha_v": alpha_v}
            smooth("roughconductor", parameters, {**rough, **ior}, min(alpha_u, alpha_v))

for int_ior, ext_ior in [(1.5, 1.0), (1.0, 1.33), (2.4, 1.1)]:
    glass = {"type": "dielectric", "int_ior": int_ior, "ext_ior": ext_ior}
    colours = {"specular_reflectance": rgb(SPECULAR), "specular_transmittance": rgb(DIFFUSE)}
    delta("dielectric", f"{int_ior} {ext_ior}", {**glass, **colours}, [0.0, 0.999999], inside=True)

for int_ior in [1.3, 1.49, 1.9]:
    for nonlinear in [False, True]:
        coat = {"int_ior": int_ior, "ext_ior": 1.0, "nonlinear": nonlinear}
        colours = {"diffuse_reflectance": rgb(DIFFUSE), "specular_reflectance": rgb(SPECULAR)}
        parameters = f"{int_ior} {int(nonlinear)}"
        smooth("plastic", parameters, {"type": "plastic", **coat, **colours}, count=12)
        delta("plastic-delta", parameters, {"type": "plastic", **coat, **colours}, [0.0])
        for distribution in ["beckmann", "ggx"]:
            for alpha in [0.02, 0.1, 0.4, 0.9]:
                rough = {"type": "roughplastic", "distribution": distribution, "alpha": alpha}
                smooth("roughplastic", f"{distribution} {alpha} {parameters}", {**rough, **coat, **colours}, alpha, count=12)

PRINCIPLED = [
    {},
    {"roughness": 0.2, "metallic": 1.0},
    {"roughness": 0.3, "metallic": 0.6, "anisotropic": 0.8, "specular": 0.9},
    {"roughness": 0.9, "sheen": 1.0, "sheen_tint": 0.7, "specular": 0.1},
    {"roughness": 0.7, "flatness": 0.8, "spec_tint": 0.6},
    {"roughness": 0.4, "clearcoat": 1.0, "clearcoat_gloss": 0.1},
    {"roughness": 0.6, "clearcoat": 0.5, "clearcoat_gloss": 0.9},
    {"roughness": 0.3, "eta": 0.8, "spec_tint": 0.5, "metallic": 0.3, "clearcoat": 0.7},
    {"roughness": 0.35, "spec_trans": 1.0, "eta": 1.5},
    {"roughness": 0.5, "spec_trans": 0.6, "metallic": 0.2, "specular": 0.7, "anisotropic": 0.4, "clearcoat": 0.3},
    {"roughness": 0.6, "spec_trans": 0.4, "eta": 0.7, "sheen": 0.5, "flatness": 0.5, "spec_tint": 0.4},
]
for given in PRINCIPLED:
    parameters = " ".join(f"{name}={value}" for name, value in given.items()) or "-"
    bsdf = mi.load_dict({"type": "principled", "base_color": rgb(DIFFUSE), **given})
    context = mi.BSDFContext()
    for i in range(32):
        wi = unit() if i > 0 else [0.0, 0.0, 1.0]
        inside = "spec_trans" in given and i % 4 >= 2
        if inside:
            wi[2] = -wi[2]
        # Where the model itself goes, every other time: each lobe in turn.
        wo = unit()
        if i % 2 == 0:
            sample, _ = bsdf.sample(context, interaction(wi), (i * 0.381966) % 1, mi.Point2f(random.random(), random.random()))
            if sample.pdf > 0:
                wo = list(sample.wo)
        elif "spec_trans" in given and i % 3 == 0:
            wo[2] = -wo[2]
        si = interaction(wi)
        value = bsdf.eval(context, si, mi.Vector3f(*wo))
        pdf = bsdf.pdf(context, si, mi.Vector3f(*wo))
        print(" | ".join(["principled", parameters, numbers(wi), numbers(wo), numbers(value), numbers([pdf])]))
