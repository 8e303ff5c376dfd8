#!/usr/bin/env bash
# All checks of the project: format, lints, documentation, tests, firmware. Runs as root or with sudo on Debian and
# Ubuntu with Rust from rustup; what else it needs it installs.
set -euo pipefail
cd "$(dirname "$0")/.."
exec </dev/null
. tests/install.sh

log=$(mktemp)
trap 'rm -f "$log"' EXIT
times=()

say() { printf '\n== %s\n' "$*"; }

# part NAME COMMAND...: runs a part of the checks and takes its time.
part() {
    local name=$1 began=$SECONDS
    shift
    say "$name"
    "$@"
    times+=("$(printf '%-13s %5d s' "$name" $((SECONDS - began)))")
}

# need_component CARGO-COMMAND COMPONENT: the same for parts of the Rust toolchain.
need_component() {
    cargo "$1" --version >/dev/null 2>&1 && return
    say "installing $2"
    rustup component add "$2" || { echo "cargo $1 is missing: rustup component add $2" >&2; exit 1; }
}

command -v cargo >/dev/null || { echo "cargo is missing: install Rust from https://rustup.rs" >&2; exit 1; }
need cc gcc
need c++ g++
need strace strace
need nbc nbc
need avr-g++ gcc-avr
need /usr/lib/avr/include/avr/io.h avr-libc
need /usr/share/arduino/hardware/arduino/avr arduino-core-avr
need /usr/include/simavr/sim_avr.h libsimavr-dev
# With its venv, which Debian packs apart.
python3 -c 'import ensurepip' 2>/dev/null || need python3-venv python3-venv
need chromium chromium
need mpirun openmpi-bin
# Its compiler comes without its headers, which Debian packs apart.
mpicc -E -include mpi.h -x c /dev/null >/dev/null 2>&1 || need mpi.h libopenmpi-dev
compgen -G '/usr/lib/llvm-*/lib/libclang.so' >/dev/null || need libclang.so libclang-dev
need_npm
need_tools
[ -d tests/micropython/node_modules ] || npm ci --prefix tests/micropython --no-audit --no-fund >/dev/null
need_component fmt rustfmt
need_component clippy clippy

# What stands behind a macro, as the catalogue of effects does, cargo does not find.
check_format() {
    cargo fmt --all --check
    rustfmt --check --edition 2024 host-sim/models/src/effects/catalogue/*.rs
}

# Which known faults they have stands in a database that not every machine reaches.
check_dependencies() {
    cargo deny check licenses bans sources
    if cargo deny fetch db >/dev/null 2>&1; then
        cargo deny --offline check advisories
    else
        echo "advisories are not looked up: their database cannot be reached"
    fi
}

# What an older compiler lacks of the standard library clippy tells (incompatible_msrv); this is what dependencies ask for.
check_rust_version() {
    cargo metadata --format-version 1 --locked | python3 -c '
import json, sys
packages = json.load(sys.stdin)["packages"]
number = lambda version: tuple(map(int, (version or "0").split(".")))
ours = next(p["rust_version"] for p in packages if p["name"] == "mindgap-command")
newer = [p["name"] + " " + p["rust_version"] for p in packages if number(p["rust_version"])[:2] > number(ours)[:2]]
sys.exit("these need a newer Rust than " + ours + ": " + ", ".join(newer) if newer else 0)'
}

check_packages() {
    cargo package --workspace --exclude mindgap-tests --exclude mindgap-fuzz --exclude mindgap-python --no-verify --allow-dirty 2>&1 | tee "$log"
    ! grep -q '^warning' "$log"
}

# Nothing is compiled twice: lints and documentation check types alone, and all tests share one build.
part format check_format
part dependencies check_dependencies
part rust-version check_rust_version
part packages check_packages
part book mdbook build
part lints cargo clippy --workspace --all-targets --features mindgap-tests/mpi -- -D warnings
part documentation env RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --workspace --features mindgap-tests/mpi
part compilation cargo test --workspace --features mindgap-tests/mpi --no-run
run_tests() { cargo test --workspace --features mindgap-tests/mpi 2>&1 | tee "$log"; }
part tests run_tests
part python tests/python/run.sh
part firmware tests/firmware/run.sh

say "time"
printf '%s\n' "${times[@]}"
say "skipped tests"
sed -n 's/^test \(.*[^ ]\) *\.\.\. ignored.*/\1/p' "$log" | grep . || echo none
say "all checks passed"
