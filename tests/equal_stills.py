"""Twelve stills whose pixels a change of structure must leave as they are.

    python3 tests/equal_stills.py PROGRAM          compares with tests/pictures/stills.txt
    python3 tests/equal_stills.py PROGRAM --keep   writes that file anew

Each still is written as EXR at 8 paths a pixel, and the values of its channels are hashed: what
the file says beside its pixels is free to change. The hashes are those of one machine's
mathematical library: before a change is judged elsewhere, keep those of the commit before it.
Needs mitsuba and numpy (tests/run.sh installs both into target/peers).
"""

import hashlib
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TESTS = Path(__file__).resolve().parent
KEPT = TESTS / "pictures" / "stills.txt"
COMMON = ["--size", "240x160", "--spp", "8"]
STILLS = {
    "denim": ["denim"],
    "silk-satin": ["silk-satin"],
    "herringbone": ["herringbone"],
    "damask": ["damask"],
    "tweed": ["tweed"],
    "twills-9": ["twills-9"],
    "jacquard": [str(TESTS / "fixtures/looms/cloth.jc5")],
    "read grid": [str(TESTS / "cases/02/bar.nrrd")],
    "light of a picture": ["oxford", "--light", str(TESTS / "cases/02/lamp-at-a-quarter.exr")],
    "hairs off": ["default", "--effects", "-hairs"],
    "level 2": ["linen-plain", "--set", "level=2"],
    "the back": ["wavy-twill", "--view", "back"],
}


def pixels(file):
    """A hash of the channels of an EXR file: their names, sizes and values."""
    import mitsuba
    import numpy

    mitsuba.set_variant("scalar_rgb")
    bitmap = mitsuba.Bitmap(str(file))
    values = numpy.asarray(bitmap)
    values = values.reshape(values.shape[0], values.shape[1], -1)
    names = [field.name for field in bitmap.struct_()]
    digest = hashlib.sha256(repr(values.shape[:2]).encode())
    for name, index in sorted((name, index) for index, name in enumerate(names)):
        digest.update(name.encode())
        digest.update(numpy.ascontiguousarray(values[:, :, index]).tobytes())
    return digest.hexdigest()[:32]


def main():
    words = sys.argv[1:]
    keep = "--keep" in words
    programs = [word for word in words if not word.startswith("--")]
    if len(programs) != 1 or len(words) != 1 + keep:
        sys.exit(__doc__)
    kept = {}
    if not keep:
        lines = KEPT.read_text().splitlines()
        kept = dict(reversed(line.split("  ", 1)) for line in lines)
    found, differ = {}, []
    with tempfile.TemporaryDirectory() as folder:
        for name, arguments in STILLS.items():
            file = Path(folder) / "still.exr"
            begun = time.monotonic()
            command = [programs[0], "still", *arguments, *COMMON, "-o", str(file)]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            found[name] = pixels(file)
            file.unlink()
            same = keep or kept.get(name) == found[name]
            if not same:
                differ.append(name)
            said = "kept" if keep else "equal" if same else "DIFFERS"
            print(f"{found[name]}  {name}: {said}, {time.monotonic() - begun:.1f} s", flush=True)
    if keep:
        KEPT.write_text("".join(f"{digest}  {name}\n" for name, digest in found.items()))
    if differ:
        sys.exit(f"{len(differ)} of {len(STILLS)} differ: {', '.join(differ)}")


main()
