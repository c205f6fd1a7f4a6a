"""The program driven as a person drives it: a real window on a virtual screen, a mouse, a
keyboard, and the eyes of a screen reader.

    python3 tests/window/by_hand.py target/release/pickglass [FOLDER]

From a WIF to a painted float, its undoing, a photograph in three weaves, another colourway,
the preview, the pick glass, a PNG, a PDF and a volume, and unsaved work that survives a
kill. What is checked is files, read back by the program's own commands or here, and what
the screen shows. Of a failure a picture of the screen, what a reader knew and what the
program said are kept in FOLDER (target/window).
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import draft
from desk import Desk, Failed, lacking, say
from exports import export_picture, export_volume, print_pages
from pictures import read_png
from screen import middle

HERE = pathlib.Path(__file__).resolve().parent
PHOTOGRAPH = HERE.parent / "pictures" / "astronaut.png"
ENDS = 24
# The float that is painted: an end, its first pick and how many.
END, PICK, LENGTH = 9, 5, 9


def require(condition, what):
    if not condition:
        raise Failed(what)


class Flow:
    """The parts of the way, in their order; each leaves the program as the next expects."""

    def __init__(self, desk, program):
        self.desk, self.program = desk, program
        self.work = desk.folder / "work"

    # What lies in files.

    def pickglass(self, *arguments):
        """A command of the program, with no window."""
        command = [self.program, *(str(argument) for argument in arguments)]
        done = subprocess.run(
            command, env=self.desk.environment, cwd=self.work, capture_output=True, text=True
        )
        require(done.returncode == 0, f"{arguments}: {done.stderr.strip()}")
        return done.stdout

    def woven(self, design):
        """Warp up by end and pick, from a design's file."""
        picture = self.work / "woven.png"
        self.pickglass("convert", design, picture, "--write", "weave")
        drawn = read_png(picture)

        def warp_up(end, pick):
            # Black is warp up, and the last row pick 1.
            return drawn.pixel(end, drawn.height - 1 - pick) == (0, 0, 0)

        return [[warp_up(end, pick) for end in range(drawn.width)] for pick in range(drawn.height)]

    def save_as(self, name):
        """Saves under a name that is typed where no dialog can open, and reads it back."""
        path = self.work / name
        self.desk.key("ctrl+shift+s")
        self.type_path(path)
        self.desk.sees(f"Saved {path}")
        return path

    def type_path(self, path):
        """Types a path into the field that stands in for a dialog."""
        desk = self.desk
        field = desk.sees("Path ", "field").name
        desk.fill(field, "field", path)
        desk.gone(field)

    def read_document(self, path):
        return pathlib.Path(path).read_text()

    def fills_of(self, design):
        """What each region is filled with."""
        return re.findall(r"fill: ([^\n]*)", self.read_document(design))

    def map_of(self, design):
        """The outlines of the regions, as a picture's pixels."""
        picture = self.work / "map.png"
        self.pickglass("convert", design, picture, "--write", "artwork")
        return read_png(picture).rows

    def yarns_of(self, design):
        """The names and colours of the yarns in use."""
        text = self.read_document(design)
        yarns = re.search(r"\byarns: \[(.*?)\]", text, re.DOTALL).group(1)
        return re.findall(r'colour: "(#\w+)"', yarns)

    def reach(self, name, role=None):
        """Turns the wheel over the panes below until what is called `name` can be clicked."""
        desk = self.desk
        top, low = desk.still("Log", "tab").rect[1] + 28, desk.size[1] - 32

        def seen():
            node = desk.find(name, role)
            if node and top < node.rect[1] and node.rect[1] + node.rect[3] < low:
                return desk.still(name, role)
            # Over labels, where no field takes the wheel for itself.
            desk.move(100, low - 8)
            desk.xdo("click", 5)
            return None

        return desk.until(f"{name!r} within reach", seen)

    def command(self, typed):
        """Finds a command in the palette and does it."""
        self.desk.key("ctrl+k")
        self.desk.fill("Command to find", "field", typed)
        self.desk.gone("Command to find")

    def passes(self):
        """Samples a pixel of the cloth that is shown: none at first sight."""
        node = self.desk.find(" spp · ", part=True)
        return int(re.match(r"(\d+) spp", node.name).group(1)) if node else 0

    # The way.

    def opens_a_wif(self):
        wif = self.work / "twill.wif"
        wif.write_text(draft.twill(ENDS))
        self.desk.start(self.program)
        self.desk.sees("Open by path")
        self.desk.key("ctrl+l")
        self.type_path(wif)
        self.desk.sees("Drawdown of Twill by hand")
        self.desk.sees(f"{ENDS} ends × {ENDS} picks")

    def paints_a_float(self):
        desk, grid = self.desk, draft.Grid(self.desk, ENDS)
        # The drawdown follows from the draft until one says otherwise.
        desk.click_at(*grid.hover(END, PICK))
        desk.click("Become a jacquard", "button")
        desk.gone("The drawdown follows from the draft")
        self.before = self.woven(self.save_as("before.ron"))
        # Without threading and treadling the drawdown has more room.
        grid = draft.Grid(desk, ENDS)
        desk.drag([grid.hover(END, PICK), grid.place(END, PICK + LENGTH - 1)])
        desk.sees("Twill by hand *")
        grid.hover(END, PICK + 2)
        told = desk.sees("float over").name
        length = int(re.search(r"float over (\d+)", told).group(1))
        require(length >= LENGTH, f"a float of {length}")
        after = self.woven(self.save_as("painted.ron"))
        for pick in range(ENDS):
            for end in range(ENDS):
                painted = end == END and PICK <= pick < PICK + LENGTH
                wanted = painted or self.before[pick][end]
                require(after[pick][end] == wanted, f"end {end} pick {pick} is {after[pick][end]}")
        require(after != self.before, "nothing was painted")

    def undoes_it(self):
        desk = self.desk
        desk.key("ctrl+z")
        desk.sees("Twill by hand *")
        require(self.woven(self.save_as("undone.ron")) == self.before, "the float is still there")
        desk.key("ctrl+shift+z")
        desk.sees("Twill by hand *")
        require(self.woven(self.save_as("redone.ron")) != self.before, "the float did not return")

    def posterises_a_photograph(self):
        desk = self.desk
        desk.key("alt+5")
        desk.sees("Picture", "field")
        desk.fill("Picture", "field", PHOTOGRAPH)
        desk.fill("Ends", "number", 120)
        desk.fill("Colours", "number", 3)
        desk.sees("120 ends ×")
        desk.click_at(*middle(self.reach("Make it the design", "button")))
        desk.sees("3 regions")
        self.three = self.save_as("three.ron")
        found = json.loads(self.pickglass("check", self.three, "--json"))
        require(found["ends"] == 120, f"{found['ends']} ends")
        require(found["weavable"], "not weavable")
        self.fills = self.fills_of(self.three)
        require(len(self.fills) == 3, f"weaves {self.fills}")

    def reassigns_a_weave(self):
        desk = self.desk
        first = desk.sees("Weave of ", "button").name
        desk.click_at(*middle(self.reach(first, "button")))
        desk.fill("Find a weave", "field", "basket", enter=False)
        desk.click("4/4 basket, 8 × 8", "button")
        desk.sees(": 4/4 basket", "button")
        desk.key("Escape")
        desk.gone("Find a weave")
        other = self.save_as("reassigned.ron")
        fills = self.fills_of(other)
        require(sum(a != b for a, b in zip(fills, self.fills)) == 1, f"{self.fills} to {fills}")
        require("4/4 basket" in "".join(fills), f"{fills}")
        require(self.woven(other) != self.woven(self.three), "the weave did not change")
        maps = [self.map_of(design) for design in (self.three, other)]
        require(maps[0] == maps[1], "the outlines changed")

    def switches_the_colourway(self):
        """In a design that has several."""
        desk = self.desk
        self.command("start page")
        desk.click("Herringbone", "button")
        desk.sees("Drawdown of Herringbone")
        own = self.yarns_of(self.save_as("own.ron"))
        desk.key("period")
        desk.sees("Herringbone *")
        other = self.yarns_of(self.save_as("other.ron"))
        require(own != other, f"still {own}")
        desk.key("ctrl+z")
        desk.sees("Herringbone *")
        require(self.yarns_of(self.save_as("own again.ron")) == own, "not undone")

    def watches_the_preview(self):
        """Closer: first sight at once, then traced pictures over it."""
        desk = self.desk
        node = desk.sees("Cloth of ")
        seen = lambda: desk.picture().crop(node.rect)
        before = desk.until("cloth", lambda: self.drawn(seen()))
        desk.move(*middle(node))
        desk.key("plus")
        desk.until("a closer look", lambda: seen().unlike(before) > 0.1)
        desk.until("a traced picture", lambda: self.passes() > 0, 240)
        traced, known = seen(), self.passes()
        desk.until("a better one", lambda: self.passes() > known, 240)
        desk.until("another picture", lambda: seen().unlike(traced) > 0.005)

    def drawn(self, picture):
        """A picture, if there is more in it than the ground."""
        return picture if picture.colours() > 200 else None

    def holds_the_pick_glass(self):
        desk = self.desk
        x, y, width, height = desk.sees("Cloth of ").rect
        at = (x + 0.4 * width, y + 0.5 * height)
        inside = (at[0] - 30, at[1] - 30, 60, 60)
        beside = (x + 4, y + 0.15 * height, 0.1 * width, 0.6 * height)
        seen = lambda rect: desk.picture().crop(rect)
        # Paused, nothing but the glass changes.
        self.command("pause refining")
        desk.sees("paused")
        desk.move(*at)
        steady = desk.until("a picture that stays", lambda: self.steady(beside))
        without = seen(inside)
        desk.xdo("keydown", "q")
        try:
            desk.until("cloth in the glass", lambda: self.looks_through(inside, without), 240)
            require(seen(beside).unlike(steady) < 0.01, "the rest changed")
        finally:
            desk.xdo("keyup", "q")
        desk.until("the cloth as it was", lambda: seen(inside).unlike(without) < 0.2)
        self.command("pause refining")

    def steady(self, rect):
        """A part of the screen, if it is the same half a second later."""
        first = self.desk.picture().crop(rect)
        time.sleep(0.5)
        return first if self.desk.picture().crop(rect).unlike(first) == 0 else None

    def looks_through(self, inside, without):
        seen = self.desk.picture().crop(inside)
        return seen.unlike(without) > 0.5 and seen.colours() > 100

    def exports(self):
        export_picture(self)
        print_pages(self)
        export_volume(self)

    def asks_before_it_closes(self):
        desk = self.desk
        self.saved = self.woven(self.save_as("saved.ron"))
        # All threads change places: no stroke could be mistaken for it.
        desk.key("ctrl+i")
        desk.sees("Herringbone *")
        desk.key("ctrl+q")
        desk.sees("Save the changes?")
        desk.click("Cancel", "button")
        desk.gone("Save the changes?")

    def survives_a_kill(self):
        desk = self.desk
        folder = desk.folder / "data" / "pickglass" / "recovery"
        copies = lambda: list(folder.glob("*.recovery"))
        # Ten seconds are what may be lost at most.
        desk.until("a recovery copy", copies, 10)
        desk.kill()
        desk.start(self.program)
        desk.click("Recover Herringbone", "button")
        desk.sees("Drawdown of Herringbone")
        desk.sees("Herringbone *")
        recovered = self.woven(self.save_as("recovered.ron"))
        inverted = [[not up for up in row] for row in self.saved]
        require(recovered == inverted, "what was not saved is lost")
        desk.until("the copy to go", lambda: not copies())

    def ends_and_offers_nothing(self):
        desk = self.desk
        desk.key("ctrl+q")
        status = desk.ended()
        require(status == 0, f"it ended with {status}")
        desk.start(self.program)
        desk.sees("recovered.ron")
        require(not desk.find("Recover ", part=True), "saved work is offered again")
        desk.key("ctrl+q")
        require(desk.ended() == 0, "it ended badly")

    WAY = [
        opens_a_wif,
        paints_a_float,
        undoes_it,
        posterises_a_photograph,
        reassigns_a_weave,
        switches_the_colourway,
        watches_the_preview,
        holds_the_pick_glass,
        exports,
        asks_before_it_closes,
        survives_a_kill,
        ends_and_offers_nothing,
    ]


def main(arguments):
    program = pathlib.Path(arguments[0]).resolve()
    keep = pathlib.Path(arguments[1] if len(arguments) > 1 else "target/window").resolve()
    missing = lacking()
    if missing:
        say("missing: " + ", ".join(missing))
        return 2
    with tempfile.TemporaryDirectory(prefix="pickglass-") as folder, Desk(folder, keep) as desk:
        flow = Flow(desk, program)
        for part in Flow.WAY:
            name, begun = part.__name__.replace("_", " "), time.monotonic()
            try:
                part(flow)
            except BaseException as failure:
                desk.keep_evidence(part.__name__)
                say(f"{name}: FAILED: {failure} (see {keep}/{part.__name__}.png)")
                if not isinstance(failure, (Failed, OSError, ValueError)):
                    raise
                return 1
            say(f"{name}: {time.monotonic() - begun:.1f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
