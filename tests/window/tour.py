"""The pictures of the window in the README: the program itself on a virtual screen.

    python3 tests/window/tour.py target/release/pickglass tests/pictures

With Pillow the pictures are written in 256 colours, a quarter of the size.
"""

import os
import pathlib
import re
import shutil
import sys
import tempfile
import time

from desk import Desk, lacking, say
from screen import middle

PHOTOGRAPH = pathlib.Path(__file__).resolve().parent.parent / "pictures" / "astronaut.png"
# The cloth refines until it has so many samples, or so long, s.
SAMPLES = 48
PATIENCE = 100


class Tour:
    def __init__(self, desk, program, folder):
        self.desk, self.program, self.folder = desk, program, pathlib.Path(folder)

    def command(self, words):
        self.desk.key("ctrl+k")
        self.desk.sees("Command to find")
        self.desk.write(words)
        self.desk.key("Return")
        self.desk.gone("Command to find")

    def rest(self):
        """The pointer where nothing is marked by it."""
        self.desk.move(*(side - 2 for side in self.desk.size))

    def samples(self):
        found = [re.match(r"(\d+) spp", node.name) for node in self.desk.nodes()]
        return max((int(match.group(1)) for match in found if match), default=0)

    def refined(self):
        begun = time.monotonic()
        while self.samples() < SAMPLES and time.monotonic() - begun < PATIENCE:
            time.sleep(1)
        say(f"{self.samples()} samples after {time.monotonic() - begun:.0f} s")

    def keep(self, name):
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.folder / f"window-{name}.png"
        self.desk.picture().save(path)
        try:
            from PIL import Image
        except ImportError:
            say(f"{path}: in all its colours, as Pillow is not there")
        else:
            few = Image.open(path).convert("RGB").quantize(256, dither=Image.Dither.NONE)
            few.save(path, optimize=True)
        say(f"{path}: {path.stat().st_size // 1000} kB")

    def draft(self):
        desk = self.desk
        desk.start(self.program, "herringbone")
        desk.sees("Drawdown of ")
        self.command("derive the draft")
        desk.sees("Threading")
        desk.key("f")
        desk.key("alt+2")
        self.rest()
        self.refined()
        self.keep("draft")

    def posterise(self):
        desk = self.desk
        # By its name alone, so that no folder of this machine is in the picture.
        shutil.copy(PHOTOGRAPH, desk.folder / "work")
        desk.start(self.program, "oxford")
        desk.sees("Drawdown of ")
        desk.key("alt+5")
        desk.fill("Picture", "field", PHOTOGRAPH.name)
        desk.fill("Ends", "number", 480)
        desk.fill("Colours", "number", 5)
        desk.sees("480 ends ×")
        node = desk.still("Make it the design", "button")
        desk.click_at(*middle(node))
        desk.sees("5 regions")
        desk.key("n")
        self.rest()
        self.refined()
        self.keep("posterise")

    def glass(self):
        desk = self.desk
        desk.start(self.program, "default")
        desk.sees("Drawdown of ")
        desk.key("ctrl+t")
        desk.key("alt+6")
        x, y, width, height = desk.sees("Cloth of ").rect
        desk.move(x + 0.45 * width, y + 0.5 * height)
        self.refined()
        desk.xdo("keydown", "q")
        try:
            time.sleep(PATIENCE / 8)
            self.keep("glass")
        finally:
            desk.xdo("keyup", "q")

    def accuracy(self):
        desk = self.desk
        desk.start(self.program, "denim")
        desk.sees("Drawdown of ")
        self.refined()
        desk.key("alt+9")
        node = desk.still("Measure", "button")
        desk.click_at(*middle(node))
        desk.sees("Stop measuring")
        desk.gone("Stop measuring", seconds=600)
        desk.fill("Budget", "field", "5 s", enter=False)
        # What the budget says of it is longer.
        listed = [n for n in desk.nodes() if re.fullmatch(r"Scatterings followed: \d+", n.name)]
        if listed:
            desk.click_at(*middle(listed[0]))
        self.rest()
        time.sleep(2)
        self.keep("accuracy")


def main(arguments):
    program, folder = (pathlib.Path(given).resolve() for given in arguments[:2])
    wanted = arguments[2:] or ["draft", "posterise", "glass", "accuracy"]
    missing = lacking()
    if missing:
        say("missing: " + ", ".join(missing))
        return 2
    os.environ.setdefault("WGPU_BACKEND", "vulkan")
    for name in wanted:
        with tempfile.TemporaryDirectory(prefix="pickglass-") as place:
            with Desk(place, "target/window") as desk:
                getattr(Tour(desk, program, folder), name)()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
