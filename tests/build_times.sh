#!/usr/bin/env bash
# What an edit costs: builds, and the tests of one system after it, seconds passed and seconds
# of processor time, as CI builds (release) and as one edits (profile edit). Printed, never
# asserted.
#
#   bash tests/build_times.sh          edits, with what is built already
#   bash tests/build_times.sh --cold   everything from nothing first, in a folder of its own
set -euo pipefail
cd "$(dirname "$0")/.."

TIMEFORMAT='%R %U %S'
tracer=src/render/path.rs
window=ui/src/window/crossing.rs
saved=$(mktemp -d)
cp "$tracer" "$saved/tracer"
cp "$window" "$saved/window"
restore() {
    cp "$saved/tracer" "$tracer"
    cp "$saved/window" "$window"
    rm -rf "$saved"
}
trap restore EXIT

# row NAME COMMAND...: one line of the table.
row() {
    local name=$1 times
    shift
    times=$({ time "$@" >/dev/null 2>&1; } 2>&1)
    awk -v name="$name" '{ printf "%-46s %7.1f s %8.1f cpu s\n", name, $1, $2 + $3 }' <<<"$times"
}

# One line more at the top: every line of the file has another number.
edit() { sed -i '1s;^;// Edited.\n;' "$1"; }

if [[ ${1:-} == --cold ]]; then
    CARGO_TARGET_DIR=$(mktemp -d)
    export CARGO_TARGET_DIR
    trap 'restore; rm -rf "$CARGO_TARGET_DIR"' EXIT
    row "all, from nothing, release" cargo test --release --workspace --no-run --quiet
fi
for profile in edit release; do
    build() { cargo build --profile "$profile" --workspace --bin pickglass --quiet; }
    tests() { cargo test --profile "$profile" --workspace --test render --quiet "$@"; }
    build >/dev/null 2>&1
    tests --no-run >/dev/null 2>&1
    edit "$tracer"
    row "$profile: the tracer edited, its tests" tests tracking::
    edit "$tracer"
    row "$profile: the tracer edited, the program" build
    edit "$window"
    row "$profile: the window edited, the program" build
done
row "release: all tests built" cargo test --release --workspace --no-run --quiet
row "release: all tests" cargo test --release --workspace --no-fail-fast --quiet
