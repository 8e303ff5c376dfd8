#!/usr/bin/env bash
# How often evolved controllers reach the target: the default, the default with
# fresh random numbers for every individual, and the paper's
# single run, for every start of a scene and so many seeds. Prints one line a controller (kind, start, seed, success in
# 200 fresh runs under the learned noise), and then the table.
#   host-sim/command/benches/success.sh SIM SCENE SEEDS >raw.csv
set -euo pipefail
[ $# -eq 3 ] || { echo "usage: $0 SIM SCENE SEEDS" >&2; exit 2; }
simulator=$1 scene=$2 seeds=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mindgap=${MINDGAP:-target/release/mindgap}

# kind OPTION…: one line for every start and seed.
measure() {
    local kind=$1 start seed
    shift
    for start in 1 2 3 4; do
        for seed in $(seq "$seeds"); do
            "$mindgap" evolve "$simulator" --scene "$scene" --start "$start" --seed "$seed" "$@" \
                --out "$work/controller.toml" >/dev/null
            "$mindgap" simulate "$simulator" "$work/controller.toml" --scene "$scene" --start "$start" --runs 200 \
                --seed 1000 --json "$work/runs.json" >/dev/null
            printf '%s,%s,%s,%s\n' "$kind" "$start" "$seed" \
                "$(sed -n 's/^  "success": \(.*\),$/\1/p' "$work/runs.json")"
        done
    done
}

echo kind,start,seed,success
measure common
measure fresh --fresh-numbers
measure paper --paper
