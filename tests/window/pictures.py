"""Pictures without a library: PNG files, and the memory of the virtual screen."""

import struct
import zlib


class Picture:
    """Rows from the top, each of `width` pixels of 3 bytes (red, green, blue)."""

    def __init__(self, width, height, rows):
        self.width, self.height, self.rows = width, height, rows

    def pixel(self, x, y):
        return tuple(self.rows[y][3 * x : 3 * x + 3])

    def crop(self, rect):
        """The part inside `rect` = (left, top, width, height)."""
        x, y, width, height = (int(value) for value in rect)
        x, y = max(x, 0), max(y, 0)
        rows = [row[3 * x : 3 * (x + width)] for row in self.rows[y : y + height]]
        return Picture(len(rows[0]) // 3 if rows else 0, len(rows), rows)

    def colours(self):
        """How many colours there are, counted up to 1000."""
        found = set()
        for row in self.rows:
            found.update(row[at : at + 3] for at in range(0, len(row), 3))
            if len(found) > 1000:
                break
        return len(found)

    def spread(self):
        """The standard deviation of the bytes: 0 where all are equal."""
        count = sum(len(row) for row in self.rows) or 1
        mean = sum(sum(row) for row in self.rows) / count
        return (sum((byte - mean) ** 2 for row in self.rows for byte in row) / count) ** 0.5

    def unlike(self, other):
        """The share of bytes that differ by more than 2 from those of `other`."""
        count = differ = 0
        for mine, its in zip(self.rows, other.rows):
            count += len(mine)
            differ += sum(abs(a - b) > 2 for a, b in zip(mine, its))
        return differ / max(count, 1)

    def save(self, path):
        """Writes a PNG."""
        raw = b"".join(b"\0" + row for row in self.rows)
        head = struct.pack(">IIBBBBB", self.width, self.height, 8, 2, 0, 0, 0)
        with open(path, "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n")
            for kind, data in [(b"IHDR", head), (b"IDAT", zlib.compress(raw)), (b"IEND", b"")]:
                sum_of = zlib.crc32(kind + data)
                file.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", sum_of))


def read_screen(path):
    """The screen of an Xvfb that was started with `-fbdir`: an XWD file of 32 bits a pixel,
    blue first."""
    with open(path, "rb") as file:
        data = file.read()
    words = struct.unpack_from(">25I", data)
    head, width, height, line, colours = words[0], words[4], words[5], words[12], words[19]
    begin, rows = head + 12 * colours, []
    for y in range(height):
        row = data[begin + y * line : begin + y * line + 4 * width]
        turned = bytearray(3 * width)
        turned[0::3], turned[1::3], turned[2::3] = row[2::4], row[1::4], row[0::4]
        rows.append(bytes(turned))
    return Picture(width, height, rows)


def read_png(path):
    """A PNG of 1 or 8 bits a sample, grey, coloured or with a palette; alpha is left out."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError(f"{path}: no PNG file")
    at, chunks = 8, {}
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        content = data[at + 8 : at + 8 + length]
        (stated,) = struct.unpack_from(">I", data, at + 8 + length)
        if zlib.crc32(kind + content) != stated:
            raise ValueError(f"{path}: the checksum of {kind} is wrong")
        chunks[kind] = chunks.get(kind, b"") + content
        at += 12 + length
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", chunks[b"IHDR"])
    samples = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[kind]
    if depth not in (1, 8) or interlaced:
        raise ValueError(f"{path}: {depth} bits a sample, interlaced {interlaced}: not read here")
    line, step = (width * samples * depth + 7) // 8, max(1, samples * depth // 8)
    raw, above, rows = zlib.decompress(chunks[b"IDAT"]), bytes(line), []
    for y in range(height):
        begin = y * (line + 1)
        above = _unfilter(raw[begin], bytearray(raw[begin + 1 : begin + 1 + line]), above, step)
        rows.append(_coloured(above, width, depth, kind, chunks.get(b"PLTE")))
    return Picture(width, height, rows)


def _unfilter(filter_type, row, above, step):
    for at in range(len(row)):
        left = row[at - step] if at >= step else 0
        up, corner = above[at], above[at - step] if at >= step else 0
        if filter_type == 1:
            guess = left
        elif filter_type == 2:
            guess = up
        elif filter_type == 3:
            guess = (left + up) // 2
        elif filter_type == 4:
            near = [(abs(up - corner), left), (abs(left - corner), up)]
            near.append((abs(left + up - 2 * corner), corner))
            guess = min(near, key=lambda one: one[0])[1]
        else:
            guess = 0
        row[at] = row[at] + guess & 255
    return bytes(row)


def _coloured(row, width, depth, kind, palette):
    if depth == 1:
        row = bytes(row[x // 8] >> (7 - x % 8) & 1 for x in range(width))
        row = row if kind == 3 else bytes(255 * bit for bit in row)
    if kind == 3:
        return b"".join(palette[3 * index : 3 * index + 3] for index in row)
    if kind in (0, 4):
        return b"".join(bytes([grey]) * 3 for grey in (row[::2] if kind == 4 else row))
    if kind == 6:
        coloured = bytearray(3 * width)
        for part in range(3):
            coloured[part::3] = row[part::4]
        return bytes(coloured)
    return row
