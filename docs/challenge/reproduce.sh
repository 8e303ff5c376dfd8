#!/bin/sh
# Makes the fixed challenge again, answers it, and writes its score beside this script: cases.csv is raw, score.json the
# counts. Twenty to thirty minutes on two free cores.
set -eu
here=$(dirname "$0")
blind=$(mktemp -d)
trap 'rm -r "$blind"' EXIT
mindgap challenge make --cases 400 --seed 31415 --out "$blind/challenge"
mindgap challenge answer "$blind/challenge"
mindgap challenge score "$blind/challenge" --csv "$here/cases.csv" --json "$here/score.json" --force
