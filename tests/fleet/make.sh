#!/usr/bin/env bash
# make.sh OUT ROBOTS [RUNS] [STEPS]: a fleet to measure with, whose robots are those of the first two dozen folders again
# and again, as hard links. A sixth of them has a weak motor and another sixth a tired battery. MINDGAP is the command.
set -euo pipefail
out=$1 robots=$2 runs=${3:-24} steps=${4:-60}
recorded=$((robots < 24 ? robots : 24))
mkdir -p "$out"
for ((i = 0; i < recorded; i++)); do
    effect=()
    ((i % 6 == 2)) && effect=(--effect motor_asymmetry=0.1)
    ((i % 6 == 5)) && effect=(--effect battery_sag)
    "${MINDGAP:-mindgap}" record --out "$(printf '%s/robot-%05d' "$out" "$i")" --runs "$runs" --steps "$steps" \
        --seed $((1000 + i)) "${effect[@]}" --quiet
done
for ((i = recorded; i < robots; i++)); do
    cp -rl "$(printf '%s/robot-%05d' "$out" $((i % recorded)))" "$(printf '%s/robot-%05d' "$out" "$i")"
done
