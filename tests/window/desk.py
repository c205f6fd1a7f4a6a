"""A desk for the program: a screen, a bus for screen readers, folders of its own, and a
hand on mouse and keyboard."""

import os
import pathlib
import shutil
import signal
import subprocess
import time

import pictures
import screen
from bus import Bus, BusError

LAUNCHERS = ["/usr/libexec/at-spi-bus-launcher", "/usr/lib/at-spi2-core/at-spi-bus-launcher"]
# A bus that starts nothing by itself: no portal, and with it no file dialog.
_CONFIG = """<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig><type>session</type><listen>unix:tmpdir={folder}</listen>
<policy context="default"><allow send_destination="*" eavesdrop="true"/><allow eavesdrop="true"/>
<allow own="*"/></policy></busconfig>
"""


class Failed(Exception):
    """Something was not as it must be."""


def launcher():
    """The program that starts the readers' bus; `None` where it is not installed."""
    return next((path for path in LAUNCHERS if os.path.exists(path)), None)


def lacking():
    """What must be installed and is not."""
    wanted = [name for name in ("Xvfb", "xdotool", "dbus-daemon") if not shutil.which(name)]
    return wanted + ([] if launcher() else ["at-spi2-core"])


class Desk:
    """Stands while the `with` block runs; `keep` is where pictures of failures go."""

    def __init__(self, folder, keep, size=(1280, 800)):
        self.folder, self.keep, self.size = pathlib.Path(folder), pathlib.Path(keep), size
        self.running, self.program, self.screen = [], None, None
        self.environment = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith(("XDG_", "DBUS_", "WAYLAND", "DISPLAY", "AT_SPI"))
        }

    def __enter__(self):
        try:
            self._set_up()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        self.end()
        for process in reversed(self.running):
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()

    def _set_up(self):
        for name in ("home", "run", "config", "data", "screen", "work"):
            (self.folder / name).mkdir(mode=0o700)
        self.environment |= {
            "HOME": str(self.folder / "home"),
            "XDG_RUNTIME_DIR": str(self.folder / "run"),
            "XDG_CONFIG_HOME": str(self.folder / "config"),
            "XDG_DATA_HOME": str(self.folder / "data"),
            # The readers' launcher forgets what it is told where it finds no store for it.
            "GSETTINGS_BACKEND": "memory",
        }
        if "PICKGLASS_CACHE" not in self.environment:
            # Exemplars take long to build; those of the user serve as well.
            cache = os.environ.get("XDG_CACHE_HOME", os.path.expanduser("~/.cache"))
            self.environment["XDG_CACHE_HOME"] = cache
        self._start_screen()
        config = self.folder / "bus.conf"
        config.write_text(_CONFIG.format(folder=self.folder / "run"))
        daemon = ["dbus-daemon", f"--config-file={config}", "--nofork", "--print-address=1"]
        address = self._started(daemon, read=True)
        self.environment["DBUS_SESSION_BUS_ADDRESS"] = address
        self._started([launcher(), "--launch-immediately"])
        session = Bus(address)
        self.until("the readers' bus", lambda: "org.a11y.Bus" in session.bus("ListNames"))
        self.readers = screen.reader_address(session)

    def _start_screen(self):
        reading, writing = os.pipe()
        width, height = self.size
        # Without -noreset it forgets all when the first client goes, while the next comes.
        shape = ["-screen", "0", f"{width}x{height}x24", "-nolisten", "tcp", "-noreset"]
        memory = ["-fbdir", str(self.folder / "screen")]
        self.running.append(
            subprocess.Popen(
                ["Xvfb", "-displayfd", str(writing), *shape, *memory],
                pass_fds=[writing],
                stderr=subprocess.DEVNULL,
            )
        )
        os.close(writing)
        with os.fdopen(reading) as number:
            self.environment["DISPLAY"] = ":" + number.readline().strip()

    def _started(self, command, read=False):
        out = subprocess.PIPE if read else subprocess.DEVNULL
        process = subprocess.Popen(
            command, env=self.environment, stdout=out, stderr=subprocess.DEVNULL, text=True
        )
        self.running.append(process)
        return process.stdout.readline().strip() if read else None

    # The program.

    def start(self, *command):
        """Starts the program and gives it the keyboard."""
        log = open(self.folder / "said", "ab")
        self.program = subprocess.Popen(
            [str(part) for part in command],
            env=self.environment,
            cwd=self.folder / "work",
            stdout=log,
            stderr=log,
        )
        log.close()
        self.screen = screen.Screen(self.readers, self.program.pid)
        found = self.until("a window", lambda: self._windows())
        self.xdo("windowfocus", "--sync", found[-1])
        self.until("something in the window", lambda: len(self.nodes()) > 5)

    def _windows(self):
        search = ["xdotool", "search", "--onlyvisible", "--class", "pickglass"]
        found = subprocess.run(search, env=self.environment, capture_output=True, text=True)
        return found.stdout.split()

    def kill(self):
        """As a crash or the system would: no time for anything."""
        self.program.send_signal(signal.SIGKILL)
        self.program.wait(30)
        self.program = None

    def ended(self, seconds=60):
        """Waits until the program ended by itself; its exit status."""
        status = self.program.wait(seconds)
        self.program = None
        return status

    def end(self):
        if self.program is not None:
            self.program.kill()
            self.program.wait(30)
            self.program = None

    # The hand.

    def xdo(self, *arguments):
        command = ["xdotool", *(str(argument) for argument in arguments)]
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True)
        if done.returncode:
            raise Failed(f"{' '.join(command)}: {done.stderr.strip()}")

    def move(self, x, y):
        self.xdo("mousemove", round(x), round(y))

    def click_at(self, x, y, button=1):
        self.move(x, y)
        self.xdo("click", "--delay", 40, button)

    def click(self, name, role=None):
        """Clicks what is called `name`, once it is there and lies still."""
        node = self.still(name, role)
        self.click_at(*screen.middle(node))
        return node

    def drag(self, places, button=1):
        """A stroke through `places`, as a hand makes one."""
        self.move(*places[0])
        self.xdo("mousedown", button)
        for (ax, ay), (bx, by) in zip(places, places[1:]):
            for step in range(1, 6):
                self.move(ax + (bx - ax) * step / 5, ay + (by - ay) * step / 5)
                time.sleep(0.02)
        self.xdo("mouseup", button)

    def key(self, *keys):
        self.xdo("key", "--delay", 40, *keys)

    def write(self, text):
        self.xdo("type", "--delay", 15, text)

    def fill(self, name, role, text, enter=True):
        """Types into a field in place of what is there. Letters that are typed before it has
        the keyboard would be commands."""
        self.still(name, role)
        # A click that comes late would move the cursor in the text.
        if self._typed(name, role) is None:
            self.click(name, role)
        self.until(f"{name!r} to be typed into", lambda: self._typed(name, role) is not None)
        self.key("ctrl+a")
        self.write(str(text))
        self.until(f"{text!r} in {name!r}", lambda: self._typed(name, role) == str(text))
        if enter:
            self.key("Return")

    def _typed(self, name, role):
        """The text of a field that has the keyboard."""
        node = self.find(name, role)
        if node is None or not node.states >> screen.FOCUSED & 1:
            return None
        try:
            return self.screen.text(node)
        except BusError:
            # A number that is not being edited has no text.
            return None

    # The eye.

    def nodes(self):
        try:
            return self.screen.nodes()
        except (BusError, OSError):
            # The window went away while it was read.
            return []

    def find(self, name, role=None, part=False):
        """The node of this name (or with it as a part), if any; of several the last, since
        what lies above comes after what it covers."""
        for node in reversed(self.nodes()):
            fits = name in node.name if part else name == node.name
            if fits and (role is None or node.role == screen.ROLES[role]):
                return node
        return None

    def sees(self, name, role=None, seconds=60):
        """Waits for a node whose name has this part."""
        return self.until(f"{name!r}", lambda: self.find(name, role, part=True), seconds)

    def gone(self, name, seconds=60):
        self.until(f"{name!r} to go", lambda: not self.find(name, part=True), seconds)

    def still(self, name, role=None, seconds=60):
        """A node of exactly this name, once two looks find it at the same place."""
        seen = []

        def look():
            node = self.find(name, role)
            seen.append(node.rect if node else None)
            return node if node and seen[-2:] == [node.rect] * 2 else None

        return self.until(f"{name!r} lying still", look, seconds)

    def picture(self):
        return pictures.read_screen(self.folder / "screen" / "Xvfb_screen0")

    def until(self, what, found, seconds=60):
        """Looks until `found` finds something, and returns it."""
        begun = time.monotonic()
        while True:
            answer = found()
            if answer:
                return answer
            if self.program is not None and self.program.poll() is not None:
                raise Failed(f"the program ended ({self.program.returncode}) before {what}")
            if time.monotonic() - begun > seconds:
                raise Failed(f"waited {seconds} s in vain for {what}")
            time.sleep(0.1)

    def keep_evidence(self, name):
        """A picture of the screen and what a reader knew, for whoever looks into a failure."""
        self.keep.mkdir(parents=True, exist_ok=True)
        screenfile = self.folder / "screen" / "Xvfb_screen0"
        if screenfile.exists():
            self.picture().save(self.keep / f"{name}.png")
        if self.screen is not None:
            lines = [f"{node.role:4} {node.rect} {node.name!r}" for node in self.nodes()]
            (self.keep / f"{name}.txt").write_text("\n".join(lines) + "\n")
        said = self.folder / "said"
        if said.exists():
            shutil.copy(said, self.keep / f"{name}.said")


def say(text):
    print(f"   {text}", flush=True)
