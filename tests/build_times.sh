#!/usr/bin/env bash
# What an edit costs: builds, and the tests of one system after it, seconds passed and seconds
# of processor time. Printed, never asserted.
#
#   bash tests/build_times.sh          an edit of the tracer, with what is built already
#   bash tests/build_times.sh --cold   everything from nothing first, in a folder of its own
set -euo pipefail
cd "$(dirname "$0")/.."

TIMEFORMAT='%R %U %S'
edited=src/render/path.rs

# row NAME COMMAND...: one line of the table.
row() {
    local name=$1 times
    shift
    times=$({ time "$@" >/dev/null 2>&1; } 2>&1)
    awk -v name="$name" '{ printf "%-46s %7.1f s %8.1f cpu s\n", name, $1, $2 + $3 }' <<<"$times"
}

build() { cargo build --release --workspace --bin pickglass --quiet; }

if [[ ${1:-} == --cold ]]; then
    CARGO_TARGET_DIR=$(mktemp -d)
    export CARGO_TARGET_DIR
    trap 'rm -rf "$CARGO_TARGET_DIR"' EXIT
    row "all, from nothing" cargo test --release --workspace --no-run --quiet
fi
build >/dev/null 2>&1
touch "$edited"
row "$edited edited: the program" build
touch "$edited"
row "$edited edited: tests of tracking" \
    cargo test --release --workspace --test render --quiet tracking::
touch ui/src/window/crossing.rs
row "ui/src/window/crossing.rs edited: the program" build
touch "$edited"
row "$edited edited: all tests built" cargo test --release --workspace --no-run --quiet
row "all tests" cargo test --release --workspace --no-fail-fast --quiet
