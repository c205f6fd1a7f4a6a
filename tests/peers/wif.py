"""A reader of WIF 1.1 written from the rules alone: what a file weaves, and in which colours.

    python3 tests/peers/wif.py FOLDER

reads every .wif in FOLDER and puts a .txt of the same name beside it: the drawdown from the
last pick to the first, `#` = warp up, then a line with the colour of each end and one with
that of each pick, rrggbb from end 1 and pick 1.
"""

import sys
from pathlib import Path


def sections(text):
    """Sections and keys in lower case; of repeated keys the last counts."""
    found, current = {}, {}
    for line in text.splitlines():
        line = line.strip()
        if not line or line.startswith(";"):
            continue
        if line.startswith("[") and line.endswith("]"):
            current = found.setdefault(line[1:-1].strip().lower(), {})
        elif "=" in line:
            key, value = line.split("=", 1)
            current[key.strip().lower()] = value.strip()
    return found


def numbers(value):
    return [int(part) for part in value.split(",") if part.strip()]


def sets(section, count):
    """A set for each of `count` threads, 0 and missing lines being none."""
    return [set(numbers(section.get(str(thread), "0"))) - {0} for thread in range(1, count + 1)]


def colours(wif, side, count):
    low, high = numbers(wif["color palette"]["range"])
    table = {
        int(key): tuple(round((value - low) * 255 / (high - low)) for value in numbers(rgb))
        for key, rgb in wif["color table"].items()
    }
    usual = numbers(wif[side]["color"])[0]
    own = wif.get(f"{side} colors", {})
    chosen = (numbers(own.get(str(thread), str(usual)))[0] for thread in range(1, count + 1))
    return ["%02x%02x%02x" % table[number] for number in chosen]


def drawdown(wif, ends, picks):
    threading = sets(wif["threading"], ends)
    if "liftplan" in wif:
        lifts = sets(wif["liftplan"], picks)
    else:
        treadles = int(wif["weaving"]["treadles"])
        tieup = sets(wif["tieup"], treadles)
        pressed = sets(wif["treadling"], picks)
        lifts = [set().union(*(tieup[treadle - 1] for treadle in pick)) for pick in pressed]
    rising = wif["weaving"].get("rising shed", "false").lower() in ("true", "on", "yes", "1")
    for lift in reversed(lifts):
        yield "".join("#" if bool(on & lift) == rising else "." for on in threading)


def main():
    for path in sorted(Path(sys.argv[1]).glob("*.wif")):
        wif = sections(path.read_text(encoding="utf-8"))
        ends, picks = (int(wif[side]["threads"]) for side in ("warp", "weft"))
        lines = [*drawdown(wif, ends, picks)]
        lines += [" ".join(colours(wif, "warp", ends)), " ".join(colours(wif, "weft", picks))]
        path.with_suffix(".txt").write_text("\n".join(lines) + "\n")


main()
