"""Renders the grids that the tests write with mitsuba 3.5.2 and compares.

usage: mitsuba.py compare FOLDER NAME [CONTROL ...]
       mitsuba.py scene FOLDER SCENE.xml NAME [CONTROL ...]
       mitsuba.py bench FOLDER VARIANT SPP

compare: exit 0 when the film NAME agrees with mitsuba in the mean and over blocks of
pixels, and every CONTROL (a film of a perturbed grid) does not; 1 otherwise.
scene: as compare, with a scene as it was exported.
bench: prints seconds and mean squared relative error against FOLDER/reference-mean.f32,
of all pixels and of all but the worst thousandth.

Versions after 3.5.2 sample SGGX wrongly for oblique directions.
"""
import json
import sys
import time
from pathlib import Path

# This file has the name of the package: look for it elsewhere.
sys.path.pop(0)

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
REPEATS, SPP = 16, 32


def load(folder, mi):
    view = json.loads((folder / "scene.json").read_text())
    nx, ny, nz = view["size"]
    read = lambda name, n: np.fromfile(folder / name, "<f4").reshape(nz, ny, nx, n)
    low, high = np.array(view["min"]), np.array(view["max"])
    T = mi.ScalarTransform4f
    box = T().translate(list(low)).scale(list(high - low))

    def grid(name, channels):
        return {
            "type": "gridvolume",
            "grid": mi.VolumeGrid(read(name, channels)),
            "to_world": box,
            "filter_type": "nearest",
            "raw": True,
        }

    roulette = min(view["roulette_order"], 1 << 30)
    scene = {
        "type": "scene",
        # Depth counts the light's end of a path too.
        "integrator": {
            "type": "volpath",
            "max_depth": view["max_order"] + 1,
            "rr_depth": roulette,
        },
        "sensor": {
            "type": "perspective",
            "fov": view["fov"],
            "fov_axis": "x",
            "near_clip": 0.001,
            "far_clip": 1e4,
            "to_world": T().look_at(origin=view["eye"], target=view["target"], up=[0, 1, 0]),
            "film": {
                "type": "hdrfilm",
                "width": view["width"],
                "height": view["height"],
                "pixel_format": "rgb",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": "independent"},
        },
        "sun": {
            "type": "directional",
            "direction": [-v for v in view["towards_sun"]],
            "irradiance": {"type": "rgb", "value": view["sun"]},
        },
        "cloth": {
            "type": "cube",
            "to_world": T().translate(list((low + high) / 2)).scale(list((high - low) / 2)),
            "bsdf": {"type": "null"},
            "interior": {
                "type": "heterogeneous",
                "albedo": grid("albedo.f32", 3),
                "sigma_t": grid("sigma.f32", 1),
                "scale": 1.0,
                "has_spectral_extinction": False,
                "phase": {"type": "sggx", "S": grid("sggx.f32", 6)},
            },
        },
    }
    if view["sky"] > 0:
        scene["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": view["sky"]}}
    return mi.load_dict(scene), view


def blocks(image, edge):
    h, w = image.shape[0] // edge * edge, image.shape[1] // edge * edge
    return image[:h, :w].reshape(h // edge, edge, w // edge, edge).mean((1, 3))


def agrees(folder, name, view, repeats):
    """Prints and answers whether the film `name` is what the repeated renderings show."""
    shape = (view["height"], view["width"])
    ours = np.fromfile(folder / f"{name}-mean.f32", "<f4").reshape(*shape, 3).astype(float)
    variance = np.fromfile(folder / f"{name}-variance.f32", "<f4").reshape(shape).astype(float)
    ours = ours @ LUMINANCE
    n = len(repeats)
    # The whole picture.
    means = repeats.mean((1, 2))
    error = np.sqrt(means.var(ddof=1) / n + variance.sum() / variance.size**2)
    z_mean = (ours.mean() - means.mean()) / error
    ok = abs(z_mean) < 4 and np.isfinite(repeats).all()
    report = f"{name}: mean {ours.mean():.5f}, mitsuba {means.mean():.5f} +- {error:.5f} (z {z_mean:+.2f})"
    # Pixels, and blocks of them, in which a small error that pixels hide becomes visible.
    for edge in (1, 4):
        peer = np.array([blocks(r, edge) for r in repeats])
        ours_variance = blocks(variance, edge) / edge**2
        z = (blocks(ours, edge) - peer.mean(0)) / np.sqrt(peer.var(0, ddof=1) / n + ours_variance)
        # Student's t with n-1 degrees has the variance (n-1)/(n-3) and a kurtosis of its own.
        spread = (z**2).mean() / ((n - 1) / (n - 3))
        limit = 1 + 4 * np.sqrt((2 + 6 / (n - 5)) / z.size)
        ok = ok and spread < limit
        report += f"; {edge}x{edge}: spread {spread:.3f} (limit {limit:.3f}), largest |z| {abs(z).max():.2f}"
    print(f"{report}: {'agrees' if ok else 'differs'}")
    return ok


def load_xml(folder, xml, mi):
    scene = mi.load_file(str(folder / xml), spp="1")
    width, height = scene.sensors()[0].film().size()
    return scene, {"width": int(width), "height": int(height)}


def compare(folder, name, controls, xml=None):
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    begun = time.time()
    scene, view = load(folder, mi) if xml is None else load_xml(folder, xml, mi)
    repeats = []
    for seed in range(REPEATS):
        image = np.array(mi.render(scene, seed=seed, spp=SPP))
        repeats.append(image.astype(float) @ LUMINANCE)
    repeats = np.array(repeats)
    print(f"mitsuba {mi.__version__}: {time.time() - begun:.1f} s")
    right = agrees(folder, name, view, repeats)
    wrong = [control for control in controls if agrees(folder, control, view, repeats)]
    for control in wrong:
        print(f"the perturbed grid {control} was not noticed")
    return 0 if right and not wrong else 1


def bench(folder, variant, spp):
    import mitsuba as mi

    mi.set_variant(variant)
    scene, view = load(folder, mi)
    # Compiles the kernels, which is not counted.
    if variant.startswith("llvm"):
        np.array(mi.render(scene, seed=99, spp=spp))
    begun, cpu = time.time(), time.process_time()
    image = np.array(mi.render(scene, seed=0, spp=spp)).astype(float) @ LUMINANCE
    seconds, cpu = time.time() - begun, time.process_time() - cpu
    shape = (view["height"], view["width"], 3)
    reference = np.fromfile(folder / "reference-mean.f32", "<f4").reshape(shape).astype(float)
    reference = reference @ LUMINANCE
    error = np.sort(((image - reference) ** 2 / (reference**2 + 1e-4)).ravel())
    most = error[: error.size - error.size // 1000]
    paths = view["width"] * view["height"] * spp
    print(
        json.dumps(
            {
                "variant": variant,
                "seconds": seconds,
                "cpu_seconds": cpu,
                "spp": spp,
                "mse": error.mean(),
                "most_mse": most.mean(),
                "mean": image.mean(),
                "reference": reference.mean(),
                "paths_per_second": paths / seconds,
            }
        )
    )
    return 0


if __name__ == "__main__":
    if len(sys.argv) >= 4 and sys.argv[1] == "compare":
        sys.exit(compare(Path(sys.argv[2]), sys.argv[3], sys.argv[4:]))
    if len(sys.argv) >= 5 and sys.argv[1] == "scene":
        sys.exit(compare(Path(sys.argv[2]), sys.argv[4], sys.argv[5:], sys.argv[3]))
    if len(sys.argv) == 5 and sys.argv[1] == "bench":
        sys.exit(bench(Path(sys.argv[2]), sys.argv[3], int(sys.argv[4])))
    print(__doc__, file=sys.stderr)
    sys.exit(2)
