#!/usr/bin/env bash
# All checks of the project: format, lints, documentation, tests, firmware. Runs as root or with sudo on Debian and
# Ubuntu with Rust from rustup; what else it needs it installs.
set -euo pipefail
cd "$(dirname "$0")/.."
exec </dev/null
. tests/install.sh

say() { printf '\n== %s\n' "$*"; }

# need_component CARGO-COMMAND COMPONENT: the same for parts of the Rust toolchain.
need_component() {
    cargo "$1" --version >/dev/null 2>&1 && return
    say "installing $2"
    rustup component add "$2" || { echo "cargo $1 is missing: rustup component add $2" >&2; exit 1; }
}

command -v cargo >/dev/null || { echo "cargo is missing: install Rust from https://rustup.rs" >&2; exit 1; }
need cc gcc
need nbc nbc
need_component fmt rustfmt
need_component clippy clippy

say "format"
cargo fmt --all --check
# One profile for everything, so that nothing is compiled twice.
say "lints"
cargo clippy --release --workspace --all-targets -- -D warnings
say "documentation"
RUSTDOCFLAGS="-D warnings" cargo doc --release --no-deps --workspace
say "tests"
cargo test --release --workspace

say "firmware"
tests/firmware/run.sh
