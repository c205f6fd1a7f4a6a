"""What a screen reader is told of the window (AT-SPI), and where it lies on the screen."""

import collections

from bus import Bus, BusError

ROLES = {
    "button": 43,
    "number": 52,
    "tab": 62,
    "field": 79,
}
# A bit of the first word of a state set.
FOCUSED = 12

_ACCESSIBLE = "org.a11y.atspi.Accessible"
_ROOT = "/org/a11y/atspi/accessible/root"

Node = collections.namedtuple("Node", "path name role rect states")


def middle(node):
    """The middle of a node on the screen, pixels."""
    x, y, width, height = node.rect
    return x + width / 2, y + height / 2


def reader_address(session):
    """Says on the session bus that somebody reads the screen; the address of that bus."""
    place = ("org.a11y.Bus", "/org/a11y/bus")
    on = (*place, "org.freedesktop.DBus.Properties", "Set")
    session.call(on, "ssv", "org.a11y.Status", "IsEnabled", ("b", True))
    return session.call((*place, "org.a11y.Bus", "GetAddress"))


class Screen:
    """The window of the process `pid`, as a reader on the bus at `address` knows it."""

    def __init__(self, address, pid):
        self.bus, self.pid, self.name = Bus(address), pid, None

    def _program(self):
        """The window's name on the bus; `None` until it has one."""
        if self.name is None:
            for name in self.bus.bus("ListNames"):
                if name.startswith(":") and self._pid_of(name) == self.pid:
                    self.name = name
        return self.name

    def _pid_of(self, name):
        try:
            return self.bus.bus("GetConnectionUnixProcessID", "s", name)
        except BusError:
            return None

    def nodes(self):
        """Everything that is shown, from the root down; empty before there is a window."""
        program = self._program()
        if program is None:
            return []
        found, level = [], [_ROOT]
        while level:
            calls = []
            for path in level:
                accessible = (program, path, _ACCESSIBLE)
                properties = (program, path, "org.freedesktop.DBus.Properties", "Get")
                component = (program, path, "org.a11y.atspi.Component", "GetExtents")
                calls += [
                    ((*accessible, "GetChildren"), "", ()),
                    (properties, "ss", (_ACCESSIBLE, "Name")),
                    ((*accessible, "GetRole"), "", ()),
                    (component, "u", (0,)),
                    ((*accessible, "GetState"), "", ()),
                ]
            answers = self.bus.call_all(calls)
            below = []
            for at, path in enumerate(level):
                children, name, role, rect, states = answers[5 * at : 5 * at + 5]
                # What went away while it was asked about is not there.
                if not isinstance(children, BusError):
                    below += [child for _, child in children]
                if not any(isinstance(answer, BusError) for answer in (name, role, rect, states)):
                    found.append(Node(path, name, role, tuple(rect), states[0]))
            level = below
        return found

    def text(self, node):
        """The text in a field."""
        where = (self._program(), node.path, "org.a11y.atspi.Text", "GetText")
        return self.bus.call(where, "ii", 0, -1)
