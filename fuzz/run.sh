#!/usr/bin/env bash
# Feeds every target with inputs that it has not had before, for so many hours: fuzz/run.sh HOURS. It ends before that where
# an input panics, takes over a second, or where the whole takes more than 256 MB. How many inputs each target has had is
# kept in target/fuzz-counts; remove it to begin anew.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -eq 1 ] || { echo "fuzz/run.sh HOURS" >&2; exit 2; }
until=$(awk -v hours="$1" -v now="$(date +%s)" 'BEGIN { printf "%d", now + 3600 * hours }')
# The binaries of tests have overflow checks and debug assertions.
cargo test --quiet -p mindgap-tests --test fuzzing --no-run
while :; do
    target/debug/fuzz 10 target/fuzz-counts
    [ "$(date +%s)" -lt "$until" ] || break
done
