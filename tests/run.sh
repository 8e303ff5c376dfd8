#!/usr/bin/env bash
# All checks of the project: format, spelling, lints, documentation, tests, firmware. Runs as root or with sudo on Debian and
# Ubuntu with Rust from rustup, and installs what else it needs. On two cores a fresh clone takes about half an hour. Tests run in
# their short form; tests/slow.sh runs the long one.
set -euo pipefail
cd "$(dirname "$0")/.."
exec </dev/null
. tests/install.sh

log=$(mktemp)
trap 'rm -f "$log"' EXIT
times=()

say() { printf '\n== %s\n' "$*"; }

# part NAME COMMAND...: runs a part of the checks and measures its time.
part() {
    local name=$1 began=$SECONDS
    shift
    say "$name"
    "$@"
    times+=("$(printf '%-13s %5d s' "$name" $((SECONDS - began)))")
}

# rustfmt does not find files behind a macro, such as those of the catalogue of effects.
check_format() {
    cargo fmt --all --check
    rustfmt --check --edition 2024 host-sim/models/src/effects/catalogue/*.rs
}

# Known faults of dependencies are in a database that not every machine can reach.
check_dependencies() {
    cargo deny check licenses bans sources
    if cargo deny fetch db >/dev/null 2>&1; then
        cargo deny --offline check advisories
    else
        echo "advisories are not checked: their database cannot be reached"
    fi
}

# Clippy reports what our code needs of a newer standard library (incompatible_msrv). This checks what dependencies need.
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
    cargo package --workspace --exclude mindgap-tests --exclude mindgap-fuzz --exclude mindgap-python --exclude mindgap-browser --no-verify --allow-dirty 2>&1 | tee "$log"
    ! grep -q '^warning' "$log"
}

run_tests() {
    cargo test --workspace --tests --no-fail-fast "${features[@]}" 2>&1 | tee "$log"
    cargo test --workspace --doc "${features[@]}" 2>&1 | tee -a "$log"
}

part tools need_all
# Every part compiles with the same features, so that no dependency is compiled twice. Lints and documentation only check types;
# all tests, and the Python package, share one build.
features=(--features mindgap-tests/mpi)
part format check_format
part spelling typos
part dependencies check_dependencies
part rust-version check_rust_version
part packages check_packages
part book mdbook build
part lints cargo clippy --workspace --all-targets "${features[@]}" --features mindgap-fuzz/libfuzzer -- -D warnings
part documentation env RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --workspace "${features[@]}"
part compilation cargo test --workspace --tests "${features[@]}" --no-run
part tests run_tests
part python tests/python/run.sh
part firmware tests/firmware/run.sh
part browser tests/browser/run.sh target/debug/mindgap-under-test

say "time"
printf '%s\n' "${times[@]}"
say "skipped tests"
sed -n 's/^test \(.*[^ ]\) *\.\.\. ignored.*/\1/p' "$log" | grep . || echo none
say "all checks passed"
