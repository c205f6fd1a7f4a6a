#!/usr/bin/env bash
# Checks everything: format, lints, tests, documentation, the window.
#
#   bash tests/run.sh            all checks
#   bash tests/run.sh --bench    the measurements instead, printed and never asserted
#   bash tests/run.sh --soak     what takes long: hard cases by the thousand, references that
#                                are missing, all views of the preview, and its first minute
#                                by the clock, printed
#
# Installs what it needs when it may (root and apt-get); otherwise it says what is
# missing and goes on, and the tests that need it say so. With CI=true nothing that is
# missing is forgiven.
set -euo pipefail
cd "$(dirname "$0")/.."

target=${CARGO_TARGET_DIR:-$PWD/target}
passed=()
took=()
missing=()
started=$SECONDS

say() { printf '%s\n' "$*"; }

have() { command -v "$1" >/dev/null 2>&1; }

# step NAME COMMAND...: runs a check, named before and counted after.
step() {
    local name=$1 begun=$SECONDS
    shift
    say "== $name"
    "$@"
    say "   $name: passed, $((SECONDS - begun)) s"
    passed+=("$name")
    took+=("$((SECONDS - begun))")
}

lacks() {
    say "   missing: $1"
    missing+=("$1")
}

# install PACKAGE...: Debian packages, where that is possible.
install() {
    local wanted=() package
    for package in "$@"; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok' || wanted+=("$package")
    done
    ((${#wanted[@]})) || return 0
    if [[ $(id -u) -ne 0 ]]; then
        lacks "${wanted[*]} (run as root once, or: sudo apt-get install ${wanted[*]})"
        return 0
    fi
    say "   installing ${wanted[*]}"
    if [[ -z ${updated:-} ]]; then
        apt-get update -qq >/dev/null 2>&1 || true
        updated=yes
    fi
    # One by one when together fails, so that one package does not keep out the others.
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${wanted[@]}" \
        >/dev/null 2>&1 && return 0
    for package in "${wanted[@]}"; do
        DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$package" \
            >/dev/null 2>&1 || lacks "$package"
    done
}

# The Rust toolchain's parts; a rustup that cannot be asked is not an error.
component() {
    cargo "$1" --version >/dev/null 2>&1 && return 0
    have rustup && rustup component add "$2" >/dev/null 2>&1 || true
    cargo "$1" --version >/dev/null 2>&1 && return 0
    lacks "cargo $1 (rustup component add $2)"
    return 1
}

prepare_system() {
    if have apt-get && have dpkg-query; then
        install mesa-vulkan-drivers libvulkan1 xvfb xauth libxkbcommon-x11-0 libxkbcommon0 \
            libx11-6 libx11-xcb1 libxcursor1 libxi6 libxrandr2 libwayland-client0 \
            xdotool dbus at-spi2-core \
            python3 python3-venv python3-openvdb libopenvdb-tools libnanovdb-tools
        [[ $bench == no ]] || install libllvm15
    else
        say "   no apt-get here: taking what is installed"
    fi
}

# A software adapter, so that every machine draws the same picture.
prepare_graphics() {
    local icd
    for icd in /usr/share/vulkan/icd.d/lvp_icd*.json; do
        if [[ -f $icd ]]; then
            export VK_DRIVER_FILES=$icd
            break
        fi
    done
    export WGPU_BACKEND=vulkan
    if [[ -z ${VK_DRIVER_FILES:-} ]]; then
        lacks "software Vulkan (mesa-vulkan-drivers)"
    fi
    XDG_RUNTIME_DIR=$scratch/run
    mkdir -m 700 "$XDG_RUNTIME_DIR"
    export XDG_RUNTIME_DIR
}

# The programs that results are compared with, in an environment of their own.
prepare_peers() {
    local peers=$target/peers
    if ! have python3; then
        lacks "python3, and with it the peers"
        return 0
    fi
    if ! "$peers/bin/python" -c 'import mitsuba, numpy, PIL, tifffile' >/dev/null 2>&1; then
        say "   installing the peers"
        python3 -m venv --clear "$peers" >"$scratch/peers.log" 2>&1 &&
            "$peers/bin/python" -m pip install --quiet --disable-pip-version-check \
                'mitsuba==3.5.2' numpy pillow tifffile >>"$scratch/peers.log" 2>&1 || true
    fi
    if "$peers/bin/python" -c 'import numpy, PIL, tifffile' >/dev/null 2>&1; then
        export PICKGLASS_PEERS_PYTHON=$peers/bin/python
    else
        lacks "Pillow and tifffile ($peers/bin/pip install pillow tifffile numpy)"
    fi
    if "$peers/bin/python" -c 'import mitsuba, numpy' >/dev/null 2>&1; then
        export PICKGLASS_MITSUBA_PYTHON=$peers/bin/python
    else
        tail -n 3 "$scratch/peers.log" 2>/dev/null || true
        lacks "mitsuba 3.5.2 (python3 -m venv $peers; $peers/bin/pip install mitsuba==3.5.2 numpy)"
    fi
    # Readers of volumes and meshes; OpenVDB's own come with the system's Python.
    local readers=(SimpleITK pynrrd tifffile trimesh)
    local imports='import SimpleITK, nrrd, tifffile, trimesh, numpy'
    if ! "$peers/bin/python" -c "$imports" >/dev/null 2>&1; then
        "$peers/bin/python" -m pip install --quiet --disable-pip-version-check numpy \
            "${readers[@]}" >>"$scratch/peers.log" 2>&1 || true
    fi
    if "$peers/bin/python" -c "$imports" >/dev/null 2>&1; then
        export PICKGLASS_VOLUMES_PYTHON=$peers/bin/python
    else
        tail -n 3 "$scratch/peers.log" 2>/dev/null || true
        lacks "readers of volumes ($peers/bin/pip install ${readers[*]})"
    fi
    have vdb_print || lacks "OpenVDB's readers (python3-openvdb libopenvdb-tools libnanovdb-tools)"
    local llvm
    for llvm in /usr/lib/x86_64-linux-gnu/libLLVM-15.so* /usr/lib/llvm-15/lib/libLLVM-15.so*; do
        if [[ -e $llvm ]]; then
            export DRJIT_LIBLLVM_PATH=$llvm
            break
        fi
    done
}

# A virtual display of our own for a command; its number is chosen by the server.
with_display() {
    local server number=""
    Xvfb -displayfd 3 -screen 0 1280x800x24 -nolisten tcp 3>"$scratch/display" 2>/dev/null &
    server=$!
    for _ in $(seq 100); do
        number=$(cat "$scratch/display")
        [[ -z $number ]] || break
        sleep 0.1
    done
    local status=0
    if [[ -n $number ]]; then
        DISPLAY=:$number WAYLAND_DISPLAY='' "$@" || status=$?
    else
        say "   the virtual display did not start"
        status=1
    fi
    kill "$server" 2>/dev/null || true
    wait "$server" 2>/dev/null || true
    return "$status"
}

smoke_window() {
    with_display timeout 300 "$target/release/pickglass" oxford --smoke-frames 20
}

# With a display and no adapter: the picture instead, and a line that names the packages.
smoke_no_adapter() {
    local folder=$scratch/no-adapter program
    program=$(cd "$target/release" && pwd)/pickglass
    mkdir -p "$folder"
    (cd "$folder" && WGPU_BACKEND=vulkan VK_DRIVER_FILES=$folder/none.json \
        with_display timeout 900 "$program" >said 2>&1) || { cat "$folder/said"; return 1; }
    if ! grep -q 'apt-get install mesa-vulkan-drivers' "$folder/said"; then
        cat "$folder/said"
        return 1
    fi
    [[ -s $folder/cloth.png ]] || { say "   cloth.png was not written"; return 1; }
}

# A device that is lost: the program starts itself again, on the same design.
smoke_lost_device() {
    local folder=$scratch/lost
    mkdir -p "$folder/home"
    # The display stays until the second program has ended, too.
    lose() {
        timeout 300 "$target/release/pickglass" oxford --json --smoke-frames 30 \
            --smoke-lose-device 5 >"$folder/said" 2>"$folder/errors" || return 1
        for _ in $(seq 600); do
            grep -q opened "$folder/said" && return 0
            sleep 0.2
        done
        return 1
    }
    if ! HOME=$folder/home XDG_DATA_HOME=$folder/home XDG_CONFIG_HOME=$folder/home \
        with_display lose; then
        cat "$folder/said" "$folder/errors"
        return 1
    fi
    # What breaks for want of the device is hushed.
    if ! grep -q 'device was lost: started again on .*[.]recovery' "$folder/errors" ||
        grep -q panicked "$folder/errors"; then
        cat "$folder/errors"
        return 1
    fi
}

# Mouse, keys and a screen reader's eyes on a screen of its own; what is lacking is told.
# Of a failure pictures are kept in $target/window. A hand waits only so long, and a busy
# machine may be slower: it tries once more.
window_by_hand() {
    local status=0
    have python3 || { lacks "python3, and with it the window by hand"; return 0; }
    flow() { python3 -B tests/window/by_hand.py "$target/release/pickglass" "$target/window"; }
    flow || status=$?
    if ((status == 1)); then
        say "   once more"
        status=0
        flow || status=$?
    fi
    if ((status == 2)); then
        lacks "what the window is driven by hand with (xdotool dbus at-spi2-core)"
        return 0
    fi
    return "$status"
}

# With no display: the picture instead, and a line that says so.
smoke_no_display() {
    local folder=$scratch/no-display program
    program=$(cd "$target/release" && pwd)/pickglass
    mkdir -p "$folder"
    (cd "$folder" && env -u DISPLAY -u WAYLAND_DISPLAY -u WAYLAND_SOCKET \
        timeout 900 "$program" >said 2>&1) || { cat "$folder/said"; return 1; }
    grep -q 'No window' "$folder/said" || { cat "$folder/said"; return 1; }
    [[ -s $folder/cloth.png ]] || { say "   cloth.png was not written"; return 1; }
}

# Builds the program as well: `cargo build` alone would give the library other features of
# its dependencies than the tests need, and all of it would be built twice.
build_tests() {
    cargo test --release --workspace --no-run --quiet
}

# Of what passes one line a program is printed, of what fails all.
run_tests() {
    local log=$scratch/tests.log status=0
    cargo test --release --workspace --no-fail-fast >"$log" 2>&1 || status=$?
    if ((status)); then
        grep -vE '^test .*[.]{3} ok$' "$log"
        return "$status"
    fi
    awk '/^ +(Running|Doc-tests) / { name = $2 == "unittests" ? $3 : $2 }
        /^test result: / { printf "%8s s %5d tests  %s\n", $NF + 0, $4, name }' "$log" | sort -rn
}

# The table of asked and shown colours, which the tests alone do not print.
print_colours() {
    # For the workspace, as all else: one package alone has other features of its
    # dependencies, and everything would be built again.
    cargo test --release --workspace --test cloth --quiet -- --nocapture colour::
}

run_docs() {
    RUSTDOCFLAGS='-D warnings' cargo doc --release --workspace --no-deps --quiet
}

check_all() {
    if component fmt rustfmt; then step "format" cargo fmt --all --check; fi
    if component clippy clippy; then
        step "lints" cargo clippy --release --workspace --all-targets --quiet -- -D warnings
    fi
    step "build of the tests" build_tests
    step "tests" run_tests
    step "colours" print_colours
    step "documentation" run_docs
    if have Xvfb; then
        step "window" smoke_window
        step "no adapter" smoke_no_adapter
        step "lost device" smoke_lost_device
        step "window by hand" window_by_hand
    else
        lacks "Xvfb, and with it the check of the window"
    fi
    step "no display" smoke_no_display
}

# What the window costs while its cloth is traced as in the program.
window_times() {
    PICKGLASS_TIMES=yes cargo test --release --workspace --quiet --bin pickglass -- \
        --nocapture --test-threads 1 tests::times
}

measure_all() {
    local file name found=no
    for file in tests/benches/*.rs; do
        [[ -f $file ]] || continue
        found=yes
        name=$(basename "$file" .rs)
        step "bench $name" cargo bench --bench "$name" --profile release
    done
    [[ $found == yes ]] || say "there is nothing to measure"
    step "times of the window" window_times
}

# The first minute of the preview by the clock, alone and with every core loaded.
first_minute() (
    loads=()
    trap '((${#loads[@]} == 0)) || kill "${loads[@]}"' EXIT
    if [[ $1 == loaded ]]; then
        for core in $(seq "$(nproc)"); do
            (trap - EXIT ERR; while :; do :; done) &
            loads+=($!)
        done
    fi
    PICKGLASS_SOAK=20 cargo test --release --workspace --quiet --bin pickglass -- \
        --nocapture --test-threads 1 first_minute_by_the_clock
)

# All views of the preview with a number of paths in the place of the clock.
never_worse() {
    PICKGLASS_SOAK=1 cargo test --release --workspace --quiet --bin pickglass -- \
        --nocapture --test-threads 1 no_picture_that_is_shown
}

# Hard cases by the thousand: designs, files, edits, events, stalls.
hard_cases() {
    local -x PICKGLASS_LONG=yes
    cargo test --release --workspace --test hard_cases -- --nocapture
    cargo test --release --workspace --test edit properties
    cargo test --release --workspace --bin pickglass -- the_last_picture random_events
}

soak_all() {
    step "hard cases" hard_cases
    step "references" cargo bench --bench preview_references --profile release
    step "never worse" never_worse
    step "first minute" first_minute alone
    step "first minute, cores loaded" first_minute loaded
}

bench=no soak=no
case ${1:-} in
'') ;;
--bench) bench=yes ;;
--soak) soak=yes ;;
*)
    say "usage: bash tests/run.sh [--bench|--soak]" >&2
    exit 2
    ;;
esac

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
trap 'say "FAILED after $((SECONDS - started)) s; passed before: ${passed[*]:-nothing}"' ERR
set -o errtrace

if [[ ${CI:-} == true ]]; then
    export GOLDEN_REQUIRED=1
fi
have cargo || { say "missing: cargo (install Rust with rustup)"; exit 1; }

say "== what is needed"
prepare_system
prepare_graphics
prepare_peers

if [[ $bench == yes ]]; then
    measure_all
elif [[ $soak == yes ]]; then
    soak_all
else
    check_all
fi

say
for index in "${!passed[@]}"; do
    printf '%6d s  %s\n' "${took[$index]}" "${passed[$index]}"
done
((${#missing[@]} == 0)) || printf 'missing: %s\n' "${missing[@]}"
printf -v list '%s, ' "${passed[@]}"
say "passed in $((SECONDS - started)) s: ${list%, }"
if [[ ${CI:-} == true && ${#missing[@]} -gt 0 ]]; then
    say "in CI nothing may be missing"
    exit 1
fi
