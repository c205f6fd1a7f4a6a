#!/usr/bin/env python3
"""What budgets come to: python3 tests/budgets.py PROGRAM [--runs 5] [DESIGN...]

Asks for a still of each design by 1, 5 and 20 seconds, so many times, and prints the median of
what it took, of the clock and of processors, and of its error, beside what was promised: where
the cloth alone takes longer than the budget, a longer time is promised, and one path a pixel.
Errors are those against a picture of so many paths a pixel more, with all effects, and not what
the program itself says of its noise. Presets where no design is named. Needs OpenEXR and numpy.
What is printed is no test: times are this machine's.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import tempfile
import time

import numpy
import OpenEXR

PRESETS = ["denim", "silk-satin", "tweed", "wavy-twill", "herringbone", "oxford"]
BUDGETS = [1.0, 5.0, 20.0]
# Luminance below which errors count absolutely, as in `film::error`.
DARK = 0.01


def luminance(file):
    """The luminance of a picture before denoising, pixel by pixel."""
    with OpenEXR.File(file, separate_channels=True) as picture:
        channels = picture.channels()
        red, green, blue = (channels[name].pixels.astype(float) for name in "RGB")
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def error(picture, reference, share):
    """The relative error of a picture, whose paths are such a share of the reference's."""
    square = (picture - reference) ** 2 / (reference**2 + DARK**2)
    # The reference begins with the picture's own paths: the rest of its noise is its own.
    return math.sqrt(square.mean() / max(1.0 - share, 0.1))


def still(program, design, options, folder):
    """One picture: its report, seconds of the clock, and of processors."""
    before = os.times()
    begun = time.monotonic()
    command = [program, "still", design, "-o", f"{folder}/still.exr", "--json", *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{design}: {done.stderr.strip()}")
    after = os.times()
    worked = (after.children_user - before.children_user) + (
        after.children_system - before.children_system
    )
    return json.loads(done.stdout), time.monotonic() - begun, worked


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("designs", nargs="*", default=PRESETS)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--size", default="96x72")
    parser.add_argument("--mm", default="10")
    parser.add_argument("--reference", type=float, default=100.0, help="seconds of each")
    args = parser.parse_intermixed_args()
    cores = os.cpu_count() or 1
    view = ["--size", args.size, "--mm", args.mm]
    print(f"{args.size}, {args.mm} mm, {cores} cores, median of {args.runs}")
    print(
        "| design | budget, s | promised, s | clock, s | processors, s a core "
        "| error promised | error | times |"
    )
    print("|---|--:|--:|--:|--:|--:|--:|--:|")
    late, wrong, all_of_them = 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for design in args.designs:
            options = [*view, "--effects", "all", "--seconds", str(args.reference)]
            best, _, _ = still(args.program, design, options, folder)
            reference = luminance(f"{folder}/still.exr")
            for budget in BUDGETS:
                runs, came = [], []
                for _ in range(args.runs):
                    options = [*view, "--budget", f"{budget}s"]
                    runs.append(still(args.program, design, options, folder))
                    share = runs[-1][0]["spp"] / best["spp"]
                    came.append(error(luminance(f"{folder}/still.exr"), reference, share))
                clock = statistics.median(run[1] for run in runs)
                worked = statistics.median(run[2] for run in runs) / cores
                seconds = statistics.median(run[0]["promise"]["seconds"] for run in runs)
                promised = statistics.median(run[0]["promise"]["error"] for run in runs)
                came = statistics.median(came)
                times = came / promised
                all_of_them += 1
                late += abs(worked / seconds - 1.0) > 0.25
                wrong += not 0.5 <= times <= 2.0
                name = os.path.basename(design)
                print(
                    f"| {name} | {budget:g} | {seconds:.2f} | {clock:.2f} | {worked:.2f} "
                    f"| {100 * promised:.0f} % | {100 * came:.0f} % | {times:.2f} |",
                    flush=True,
                )
    print(
        f"\nof {all_of_them}: {all_of_them - late} within a quarter of the time of processors, "
        f"{all_of_them - wrong} within twice the error"
    )


if __name__ == "__main__":
    main()
