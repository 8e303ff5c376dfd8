#!/usr/bin/env bash
# Feeds every target with inputs that it has not had before, for so many hours: fuzz/run.sh HOURS. It ends before that where
# an input panics, takes over a second, or where the whole takes more than 256 MB.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -eq 1 ] || { echo "fuzz/run.sh HOURS" >&2; exit 2; }
until=$(awk -v hours="$1" -v now="$(date +%s)" 'BEGIN { printf "%d", now + 3600 * hours }')
round=20000
first=0
while :; do
    MINDGAP_FIRST=$first MINDGAP_INPUTS=$round cargo test --quiet -p mindgap-tests --test fuzzing -- --nocapture |
        grep 'the slowest took'
    first=$((first + round))
    echo "== $first inputs for each target"
    [ "$(date +%s)" -lt "$until" ] || break
done
