"""Exporting as a person does it, and reading what was written: a picture, pages, a volume."""

import array
import re
import struct
import zlib

from desk import Failed
from pictures import read_png

WIDTH = 160
# Window and fineness of the volume: ends, picks, voxels a crossing.
ENDS, PICKS, FINE = 3, 2, 12


def require(condition, what):
    if not condition:
        raise Failed(what)


def export_picture(flow):
    desk, path = flow.desk, flow.work / "cloth.png"
    desk.key("ctrl+e")
    desk.fill("Width", "number", WIDTH)
    desk.fill("Refine for, value", "number", 2)
    desk.fill("File", "field", path)
    desk.click("Render", "button")
    desk.sees(f"Wrote {path}", seconds=240)
    picture = read_png(path)
    require(picture.width == WIDTH and picture.height > 16, f"{picture.width} pixels wide")
    require(picture.colours() > 200, f"{picture.colours()} colours")
    require(picture.spread() > 10, f"a spread of {picture.spread():.1f}: grey all over")


def print_pages(flow):
    desk, path = flow.desk, flow.work / "draft.pdf"
    desk.key("ctrl+p")
    flow.type_path(path)
    desk.sees(f"Wrote {path}", seconds=120)
    data = path.read_bytes()
    require(data.startswith(b"%PDF-") and data.rstrip().endswith(b"%%EOF"), "no whole PDF")
    (table,) = re.findall(rb"startxref\s+(\d+)\s+%%EOF", data)
    require(data[int(table) :].startswith(b"xref") or b"/XRef" in data, "no table of objects")
    pages = len(re.findall(rb"/Type\s*/Page\b", data))
    require(pages >= 1, "no pages")
    streams = re.findall(rb"/Length \d+.*?stream\r?\n(.*?)\r?\nendstream", data, re.DOTALL)
    require(any(len(_inflated(stream)) > 500 for stream in streams), "the pages are empty")


def _inflated(stream):
    try:
        return zlib.decompress(stream)
    except zlib.error:
        return stream


def export_volume(flow):
    desk, path = flow.desk, flow.work / "corner.nrrd"
    flow.command("export volume")
    desk.fill("Ends", "number", ENDS)
    desk.fill("Picks", "number", PICKS)
    desk.fill("Voxels a crossing", "number", FINE)
    desk.fill("File", "field", path)
    desk.click("Count the bytes", "button")
    desk.still("Write", "button", 240)
    require(not path.exists(), "written before it was asked for")
    told = desk.sees(" voxels of ").name
    desk.click("Write", "button")
    desk.sees(f"Wrote {path}", seconds=240)
    sizes, values = _read_nrrd(path)
    require(" × ".join(map(str, sizes[-3:])) in told, f"{sizes}, but {told!r} was said")
    require(min(sizes[-3:]) > 4, f"{sizes}")
    require(len(values) == _product(sizes), f"{len(values)} values for {sizes}")
    filled = sum(value > 0 for value in values) / len(values)
    require(0.05 < filled < 0.95, f"{filled:.0%} of the voxels are yarn")


def _product(sizes):
    product = 1
    for size in sizes:
        product *= size
    return product


def _read_nrrd(path):
    data = path.read_bytes()
    require(data.startswith(b"NRRD000"), "no NRRD file")
    end = data.index(b"\n\n")
    head = dict(
        line.split(": ", 1) for line in data[:end].decode().splitlines()[1:] if ": " in line
    )
    require(head["encoding"] == "raw", f"{head['encoding']} is not read here")
    code = {"float": "f", "uint8": "B", "uchar": "B", "unsigned char": "B"}[head["type"]]
    values = array.array(code, data[end + 2 :])
    if struct.pack("=H", 1) == b"\0\1":
        values.byteswap()
    return [int(size) for size in head["sizes"].split()], values
