"""Reads volumes that the tests write with the libraries of others and compares.

usage: volumes.py READER FILE TRUTH

READER is pynrrd, simpleitk, tifffile, openvdb, mitsuba or trimesh. TRUTH is a folder with
raw little-endian floats (x fastest, components side by side) and frame.json; for trimesh
it is the number of tubes. Exit 0 when every voxel and the frame agree, 1 when they do
not, 3 when the library is not there, 4 when it refuses the file.
"""
import json
import sys
from pathlib import Path

# Files here have the names of packages: look for those elsewhere.
sys.path.pop(0)

try:
    import numpy as np
except ImportError:
    sys.exit(3)

wrong = []


def expect(what, found, wanted, tolerance=0.0):
    found, wanted = np.asarray(found, float), np.asarray(wanted, float)
    if found.shape != wanted.shape:
        wrong.append(f"{what}: shape {found.shape}, wanted {wanted.shape}")
        return
    bad = ~(np.abs(found - wanted) <= tolerance)
    if bad.any():
        at = tuple(int(k[0]) for k in np.nonzero(bad)) if bad.shape else ()
        wrong.append(f"{what}: {bad.sum()} differ, first at {at}: {found[at]}, wanted {wanted[at]}")


class Truth:
    def __init__(self, folder):
        self.folder = folder
        frame = json.loads((folder / "frame.json").read_text())
        self.size, self.edge = frame["size"], frame["edge"]
        self.low, self.densest = np.array(frame["origin"]), frame["densest"]
        self.first = self.low + 0.5 * self.edge

    def __call__(self, name, components=1):
        """Indexed z, y, x and component."""
        nx, ny, nz = self.size
        numbers = np.fromfile(self.folder / f"{name}.f32", "<f4")
        return numbers.reshape((nz, ny, nx) + ((components,) if components > 1 else ()))


def part(path, name):
    return path.with_name(f"{path.stem}.{name}{path.suffix}")


def read_pynrrd(path, truth):
    import nrrd

    def one(file, name, components=1):
        numbers, head = nrrd.read(str(file), index_order="C")
        expect(name, numbers, truth(name, components))
        expect("origin", head["space origin"], truth.first, 1e-12)
        axes = np.array(head["space directions"], float)[-3:]
        expect("axes", axes, np.eye(3) * truth.edge, 1e-15)
        if list(head["space units"]) != ["mm"] * 3:
            wrong.append(f"units {head['space units']}")

    one(path, "sigma")
    one(part(path, "albedo"), "albedo", 3)
    one(part(path, "sggx"), "sggx", 6)
    one(part(path, "yarn"), "yarn")


def read_simpleitk(path, truth):
    import SimpleITK as sitk

    def one(file, name, components=1):
        image = sitk.ReadImage(str(file))
        expect(name, sitk.GetArrayFromImage(image), truth(name, components))
        expect("origin", image.GetOrigin(), truth.first, 1e-9)
        expect("spacing", image.GetSpacing(), [truth.edge] * 3, 1e-12)
        expect("direction", image.GetDirection(), np.eye(3).ravel())

    one(path, "sigma")
    one(part(path, "albedo"), "albedo", 3)
    one(part(path, "sggx"), "sggx", 6)
    one(part(path, "yarn"), "yarn")


def read_tifffile(path, truth):
    import tifffile

    unit = truth.densest / 65535
    with tifffile.TiffFile(path) as file:
        pages = [page.asarray() for page in file.pages]
        described = file.pages[0].description
    expect("sigma", np.array(pages) * unit, truth("sigma"), 0.501 * unit)
    expect("sigma as one stack", tifffile.imread(path), np.array(pages))
    if f"spacing={truth.edge}" not in described:
        wrong.append(f"description {described!r}")
    expect("yarn", tifffile.imread(part(path, "yarn")), truth("yarn") + 1)


def read_openvdb(path, truth):
    import pyopenvdb as vdb

    grids = {grid.name: grid for grid in vdb.readAllGridMetadata(str(path))}
    nx, ny, nz = truth.size

    def one(name, of, components=1, background=0):
        grid = vdb.read(str(path), name)
        shape = (nx, ny, nz) + ((components,) if components > 1 else ())
        numbers = np.full(shape, background, np.float32)
        grid.copyToArray(numbers)
        axes = (2, 1, 0, 3) if components > 1 else (2, 1, 0)
        wanted = truth(of, components).copy()
        empty = truth("sigma") == 0
        wanted[empty] = background
        expect(name, numbers.transpose(axes), wanted)
        if grid.activeVoxelCount() != (~empty).sum():
            wrong.append(f"{name}: {grid.activeVoxelCount()} active, wanted {(~empty).sum()}")
        expect("voxel", grid.transform.voxelSize(), [truth.edge] * 3, 1e-12)
        expect("first", grid.transform.indexToWorld((0, 0, 0)), truth.first, 1e-9)

    one("density", "sigma")
    one("direction", "direction", 3)
    one("albedo", "albedo", 3)
    one("roughness", "alpha")
    one("yarn", "yarn", background=-1)
    if grids["density"].gridClass != "fog volume":
        wrong.append(f"class {grids['density'].gridClass}")


def read_mitsuba(path, truth):
    import mitsuba as mi

    mi.set_variant("scalar_rgb")

    def one(file, name, components=1):
        grid = mi.VolumeGrid(str(file))
        numbers = np.array(grid)
        wanted = truth(name, components)
        expect(name, numbers.reshape(wanted.shape), wanted)
        if not np.isclose(grid.max(), wanted.max()):
            wrong.append(f"{name}: largest {grid.max()}, wanted {wanted.max()}")
        box = grid.bbox() if hasattr(grid, "bbox") else None
        if box is not None:
            expect("box", list(box.min) + list(box.max), list(truth.low) + list(truth.low + np.array(truth.size) * truth.edge), 1e-5)

    one(path, "sigma")
    one(part(path, "albedo"), "albedo", 3)
    one(part(path, "sggx"), "sggx", 6)


def read_trimesh(path, tubes):
    import trimesh

    how = {"split_object": True, "group_material": False} if path.suffix == ".obj" else {}
    scene = trimesh.load(str(path), process=False, **how)
    parts = scene.geometry.values() if hasattr(scene, "geometry") else [scene]
    meshes = [mesh for mesh in parts if isinstance(mesh, trimesh.Trimesh)]
    if len(meshes) != tubes:
        wrong.append(f"{len(meshes)} meshes, wanted {tubes}")
    for mesh in meshes:
        mesh.merge_vertices(merge_norm=True, merge_tex=True)
        if not mesh.is_watertight or not mesh.is_winding_consistent:
            wrong.append("a tube is not closed")
        if not mesh.volume > 0:
            wrong.append(f"a tube is inside out: volume {mesh.volume}")
    print("bounds", scene.bounds.tolist())


readers = {
    "pynrrd": read_pynrrd,
    "simpleitk": read_simpleitk,
    "tifffile": read_tifffile,
    "openvdb": read_openvdb,
    "mitsuba": read_mitsuba,
}

if __name__ == "__main__":
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    name, path, truth = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
    try:
        if name == "trimesh":
            read_trimesh(path, int(truth))
        else:
            readers[name](path, Truth(Path(truth)))
    except ImportError as error:
        print(error)
        sys.exit(3)
    except Exception as error:
        # A file that cannot be read is not a file that differs.
        print(f"{name} {path.name}: {error!r}", file=sys.stderr)
        sys.exit(4)
    for line in wrong:
        print(f"{name} {path.name}: {line}")
    sys.exit(1 if wrong else 0)
