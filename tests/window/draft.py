"""The draft on the screen: a WIF to begin with, and where a crossing lies."""

import re

from desk import Failed

# Crossings are smaller than this, pixels.
LARGEST = 64


def twill(ends):
    """A 2/2 twill on four shafts as a WIF."""
    threads = range(1, ends + 1)
    straight = "\n".join(f"{thread}={(thread - 1) % 4 + 1}" for thread in threads)
    ties = "\n".join(f"{treadle}={treadle},{treadle % 4 + 1}" for treadle in range(1, 5))
    half = "Units=Centimeters\nSpacing=0.05\n"
    return f"""[WIF]
Version=1.1
Date=April 20, 1997
Developers=nobody@example.org
Source Program=by hand
[CONTENTS]
COLOR PALETTE=yes
COLOR TABLE=yes
[TEXT]
Title=Twill by hand
[WEAVING]
Shafts=4
Treadles=4
Rising Shed=yes
[WARP]
Threads={ends}
{half}Color=1
[WEFT]
Threads={ends}
{half}Color=2
[COLOR PALETTE]
Entries=2
Range=0,255
[COLOR TABLE]
1=28,44,96
2=238,228,204
[THREADING]
{straight}
[TIEUP]
{ties}
[TREADLING]
{straight}
"""


class Grid:
    """Where crossings lie, found out by hovering: the status line names end and pick by their
    numbers in files, from 1; here both count from 0. In the US layout the draft is turned by
    180°, so that ends run to the left and picks downwards: `way` is -1 then."""

    def __init__(self, desk, ends):
        self.desk, self.ends = desk, ends
        x, y, width, height = self.rect = desk.sees("Drawdown of ").rect
        middle = x + width // 2, y + height // 2
        across = self._edge(lambda by: self._told(middle[0] + by, middle[1])[0])
        upward = self._edge(lambda by: self._told(middle[0], middle[1] - by)[1])
        self.left, self.low = middle[0] + across, middle[1] - upward
        self.first = self._told(self.left, self.low)
        # The next thread has the next number, or the one before.
        on = (self.first[0] - self._told(*middle)[0]) % self.ends
        self.way = 1 if on == 1 else -1
        self.cell = self._cell(min(self.rect[0] + self.rect[2] - self.left - 4, 200))

    def _edge(self, told):
        """How far it is to where another thread begins."""
        here, near, far = told(0), 0, LARGEST
        while far - near > 1:
            between = (near + far) // 2
            near, far = (between, far) if told(between) == here else (near, between)
        return far

    def _cell(self, reach):
        """The size of a crossing, from how many lie within `reach` pixels."""
        end, _ = self._told(self.left + reach, self.low)
        count = self.way * (end - self.first[0]) % self.ends
        sizes = [size for size in range(2, LARGEST) if reach // size == count]
        if not sizes:
            raise Failed(f"{count} ends in {reach} pixels")
        return sizes[len(sizes) // 2]

    def _told(self, x, y):
        """End and pick under a place, as the status line says once the pointer is there."""
        # What it said of another place must not be taken for this one.
        self.desk.move(*self._outside())
        self.desk.until("no crossing", lambda: self._status() is None)
        self.desk.move(x, y)
        end, pick = self.desk.until(f"a crossing at {x}, {y}", self._status)
        return end - 1, pick - 1

    def _outside(self):
        return self.desk.size[0] // 2, self.desk.size[1] - 8

    def _status(self):
        for node in self.desk.nodes():
            found = re.match(r"end (\d+) · pick (\d+) · ", node.name)
            if found:
                return int(found.group(1)), int(found.group(2))
        return None

    def place(self, end, pick):
        """The middle of a crossing."""
        columns = self.way * (end - self.first[0])
        rows = self.way * (pick - self.first[1])
        return (
            self.left + (columns + 0.5) * self.cell,
            self.low - (rows + 0.5) * self.cell,
        )

    def hover(self, end, pick):
        """Moves the pointer onto a crossing and sees that it is this one."""
        place = self.place(end, pick)
        found = self._told(*place)
        if found != (end, pick):
            raise Failed(f"end and pick {found} lie at {place}, not {(end, pick)}")
        return place
