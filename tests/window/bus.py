"""A client of D-Bus, as much of it as reading a screen needs: calls without file
descriptors, little endian, over a Unix socket."""

import os
import socket
import struct

# Calls sent before their answers are read: neither side's buffer fills.
AT_ONCE = 100

_FIXED = {
    "y": ("<B", 1),
    "b": ("<I", 4),
    "n": ("<h", 2),
    "q": ("<H", 2),
    "i": ("<i", 4),
    "u": ("<I", 4),
    "x": ("<q", 8),
    "t": ("<Q", 8),
    "d": ("<d", 8),
}


class BusError(Exception):
    """The other side refused, or is gone."""


def _align(code):
    if code in _FIXED:
        return _FIXED[code][1]
    return {"s": 4, "o": 4, "g": 1, "v": 1, "a": 4, "(": 8, "{": 8}[code]


def _first(signature):
    """The first whole type of a signature, and the rest."""
    if signature[0] == "a":
        inner, rest = _first(signature[1:])
        return "a" + inner, rest
    if signature[0] in "({":
        depth = 0
        for at, letter in enumerate(signature):
            depth += (letter in "({") - (letter in ")}")
            if depth == 0:
                return signature[: at + 1], signature[at + 1 :]
    return signature[0], signature[1:]


def _types(signature):
    while signature:
        one, signature = _first(signature)
        yield one


class _Reader:
    def __init__(self, data):
        self.data, self.at = data, 0

    def pad(self, to):
        self.at += -self.at % to

    def take(self, signature):
        code = signature[0]
        self.pad(_align(code))
        if code in _FIXED:
            layout, size = _FIXED[code]
            (value,) = struct.unpack_from(layout, self.data, self.at)
            self.at += size
            return value
        if code in "so":
            length = self.take("u")
            text = self.data[self.at : self.at + length].decode()
            self.at += length + 1
            return text
        if code == "g":
            length = self.take("y")
            text = self.data[self.at : self.at + length].decode()
            self.at += length + 1
            return text
        if code == "v":
            return self.take(self.take("g"))
        if code == "a":
            length = self.take("u")
            self.pad(_align(signature[1]))
            end, items = self.at + length, []
            while self.at < end:
                items.append(self.take(signature[1:]))
            return items
        return tuple(self.take(part) for part in _types(signature[1:-1]))


class _Writer:
    def __init__(self):
        self.data = bytearray()

    def pad(self, to):
        self.data += bytes(-len(self.data) % to)

    def put(self, code, value):
        self.pad(_align(code))
        if code in _FIXED:
            self.data += struct.pack(_FIXED[code][0], value)
        elif code in "so":
            text = value.encode()
            self.put("u", len(text))
            self.data += text + b"\0"
        elif code == "g":
            self.data += bytes([len(value)]) + value.encode() + b"\0"
        elif code == "v":
            kind, inner = value
            self.put("g", kind)
            self.put(kind, inner)
        else:
            raise ValueError(f"nothing here sends a {code!r}")


def _message(serial, where, signature, arguments):
    destination, path, interface, member = where
    body = _Writer()
    for code, value in zip(signature, arguments):
        body.put(code, value)
    fields = _Writer()
    named = [(1, "o", path), (2, "s", interface), (3, "s", member), (6, "s", destination)]
    if signature:
        named.append((8, "g", signature))
    for number, kind, value in named:
        fields.pad(8)
        fields.put("y", number)
        fields.put("v", (kind, value))
    head = struct.pack("<cBBBIII", b"l", 1, 0, 1, len(body.data), serial, len(fields.data))
    whole = bytearray(head) + fields.data
    whole += bytes(-len(whole) % 8)
    return bytes(whole + body.data)


class Bus:
    """A connection; `address` as in DBUS_SESSION_BUS_ADDRESS."""

    def __init__(self, address):
        parts = dict(part.split("=", 1) for part in address.split(":", 1)[1].split(","))
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(30)
        self.socket.connect(parts["path"] if "path" in parts else "\0" + parts["abstract"])
        self.serial, self.read = 0, b""
        user = str(os.getuid()).encode().hex().encode()
        self.socket.sendall(b"\0AUTH EXTERNAL " + user + b"\r\n")
        if not self.socket.recv(4096).startswith(b"OK"):
            raise BusError(f"{address}: not let in")
        self.socket.sendall(b"BEGIN\r\n")
        self.bus("Hello")

    def bus(self, member, signature="", *arguments):
        """Asks the bus itself."""
        name = "org.freedesktop.DBus"
        return self.call((name, "/org/freedesktop/DBus", name, member), signature, *arguments)

    def call(self, where, signature="", *arguments):
        """Calls `where` = (destination, path, interface, member); its answer, unpacked
        where it is one value."""
        (answer,) = self.call_all([(where, signature, arguments)])
        if isinstance(answer, BusError):
            raise answer
        return answer

    def call_all(self, calls):
        """Answers of many calls in their order; a refused one is a `BusError` among them."""
        answers = []
        for begin in range(0, len(calls), AT_ONCE):
            some = calls[begin : begin + AT_ONCE]
            first, sent = self.serial + 1, b""
            for where, signature, arguments in some:
                self.serial += 1
                sent += _message(self.serial, where, signature, arguments)
            self.socket.sendall(sent)
            found = {}
            while len(found) < len(some):
                serial, answer = self._receive()
                if serial is not None and serial >= first:
                    found[serial] = answer
            answers += [found[first + at] for at in range(len(some))]
        return answers

    def _bytes(self, count):
        while len(self.read) < count:
            more = self.socket.recv(1 << 16)
            if not more:
                raise BusError("the bus is gone")
            self.read += more
        taken, self.read = self.read[:count], self.read[count:]
        return taken

    def _receive(self):
        """The serial that is answered, if any, and the answer."""
        head = self._bytes(16)
        kind = head[1]
        body_length, _, fields_length = struct.unpack_from("<III", head, 4)
        fields = self._bytes(fields_length + -fields_length % 8)
        # Alignment counts from the message's first byte.
        reader = _Reader(head + fields)
        reader.at = 12
        known = dict(reader.take("a(yv)"))
        body = self._bytes(body_length)
        reader = _Reader(body)
        values = [reader.take(one) for one in _types(known.get(8, ""))]
        if kind == 3:
            return known.get(5), BusError(f"{known.get(4)}: {' '.join(map(str, values))}")
        answer = values[0] if len(values) == 1 else values
        return (known.get(5) if kind == 2 else None), answer
