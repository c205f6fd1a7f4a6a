#!/usr/bin/env python3
"""What budgets come to: python3 tests/budgets.py PROGRAM [--runs 5] [DESIGN...]

Asks for a still of each design by 1, 5 and 20 seconds, so many times, and prints the median of
what it took, of the clock and of processors, and of its error, beside what was promised: where
the cloth alone takes longer than the budget, a longer time is promised, and one path a pixel, of
which no error is known. Presets where no design is named. What is printed is no test: times are
this machine's.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import tempfile
import time

PRESETS = ["denim", "silk-satin", "tweed", "wavy-twill", "herringbone", "oxford"]
BUDGETS = [1.0, 5.0, 20.0]


def still(program, design, options, folder):
    """One picture: its report, seconds of the clock, and of processors."""
    before = os.times()
    begun = time.monotonic()
    command = [program, "still", design, "-o", f"{folder}/a.png", "--json", *options]
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
    args = parser.parse_args()
    cores = os.cpu_count() or 1
    view = ["--size", args.size, "--mm", args.mm]
    print(f"{args.size}, {args.mm} mm, {cores} cores, median of {args.runs}")
    print(
        "| design | budget, s | promised, s | clock, s | processors, s a core "
        "| error promised | error | times |"
    )
    print("|---|--:|--:|--:|--:|--:|--:|--:|")
    late, wrong, untold, all_of_them = 0, 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for design in args.designs:
            # Exemplars are kept from here on.
            still(args.program, design, [*view, "--spp", "1"], folder)
            for budget in BUDGETS:
                runs = [
                    still(args.program, design, [*view, "--budget", f"{budget}s"], folder)
                    for _ in range(args.runs)
                ]
                clock = statistics.median(run[1] for run in runs)
                worked = statistics.median(run[2] for run in runs) / cores
                seconds = statistics.median(run[0]["promise"]["seconds"] for run in runs)
                promised = statistics.median(run[0]["promise"]["error"] for run in runs)
                bias = statistics.median(run[0]["promise"]["bias"] for run in runs)
                noise = [run[0]["error"] for run in runs if run[0]["error"] is not None]
                known = 2 * len(noise) > len(runs)
                came = math.hypot(statistics.median(noise), bias) if known else math.nan
                times = came / promised
                all_of_them += 1
                late += abs(worked / seconds - 1.0) > 0.25
                wrong += known and not 0.5 <= times <= 2.0
                untold += not known
                name = os.path.basename(design)
                print(
                    f"| {name} | {budget:g} | {seconds:.2f} | {clock:.2f} | {worked:.2f} | {100 * promised:.0f} % "
                    f"| {100 * came:.0f} % | {times:.2f} |",
                    flush=True,
                )
    print(
        f"\nof {all_of_them}: {all_of_them - late} within a quarter of the time of processors, "
        f"{all_of_them - wrong - untold} within twice the error, {untold} of one path a pixel"
    )


if __name__ == "__main__":
    main()
