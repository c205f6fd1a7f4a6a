"""Reads images by Pillow and tifffile and compares them with patterns given as text.

    images.py compare LIST

LIST has one line an image: path, TAB, text file. A text file has one row of the image a
line, from the top: `#` and `.` for black and white, or colours as rrggbb separated by
blanks. Prints each verdict; exits 1 if an image differs from its text in any pixel.
"""

import sys

import numpy
import tifffile
from PIL import Image


def wanted(path):
    """The pixels of a text file, height x width x 3."""
    rows = []
    with open(path, encoding="utf-8") as text:
        for line in text.read().splitlines():
            if set(line) <= set("#."):
                rows.append([(0, 0, 0) if c == "#" else (255, 255, 255) for c in line])
            else:
                rows.append([tuple(bytes.fromhex(word)) for word in line.split()])
    return numpy.array(rows, dtype=numpy.uint8)


def by_pillow(path):
    with Image.open(path) as image:
        return numpy.asarray(image.convert("RGB")), image.mode


def by_tifffile(path):
    """The displayed colours by the tags, with nothing left to a library's conversions."""
    with tifffile.TiffFile(path) as file:
        page = file.pages[0]
        pixels = page.asarray()
        photometric = int(page.photometric)
        if photometric == 3:
            table = page.colormap.T >> 8
            return table[pixels].astype(numpy.uint8)
        most = (1 << page.bitspersample) - 1
        grey = pixels.astype(numpy.uint32) * 255 // most
        grey = (255 - grey if photometric == 0 else grey).astype(numpy.uint8)
        return numpy.stack([grey] * 3, axis=-1)


def main():
    if sys.argv[1:2] != ["compare"] or len(sys.argv) != 3:
        print(__doc__)
        return 2
    wrong = 0
    with open(sys.argv[2], encoding="utf-8") as listing:
        for line in listing.read().splitlines():
            path, text = line.split("\t")
            pixels = wanted(text)
            found, mode = by_pillow(path)
            readers = [("Pillow", found)]
            if path.endswith((".tif", ".tiff")):
                readers.append(("tifffile", by_tifffile(path)))
            for reader, found in readers:
                same = found.shape == pixels.shape and bool((found == pixels).all())
                wrong += not same
                print(f"{'same' if same else 'DIFFERS'}\t{reader}\t{mode}\t{path}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
