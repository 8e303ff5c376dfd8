#!/usr/bin/env bash
# run.sh MINDGAP: makes the page for a browser and tests it: its module in Node, which has to give the same bytes as the command
# MINDGAP, and the whole page in Chromium. Pictures of the page are left in target/pages.
set -euo pipefail
mindgap=$(realpath "$1")
cd "$(dirname "$0")/../.."
. tests/install.sh
need_npm
need chromium chromium

host-sim/browser/build.sh
inputs=$(mktemp -d)
trap 'rm -rf "$inputs"' EXIT
pictures=$PWD/target/pages
mkdir -p "$inputs/expected" "$pictures"

make_inputs() {
    cd "$inputs"
    "$mindgap" record --out sound --runs 12 --steps 40
    "$mindgap" record --out worn --runs 6 --steps 30 --effect drive_scale=0.8 --seed 9
    "$mindgap" train sound --out simulator.json
    "$mindgap" check worn --json expected/check.json >expected/check.txt
    "$mindgap" diagnose simulator.json worn --json expected/diagnosis.json --html expected/diagnosis.html >expected/diagnosis.txt
    "$mindgap" diagnose kinematic worn --json expected/textbook.json
    python3 -m zipfile -c worn.zip worn simulator.json
    cp sound/run-000.csv drive.csv
    "$mindgap" import streams drive.csv --out imported
}

(make_inputs) >"$inputs/log" 2>&1 || { cat "$inputs/log" >&2; exit 1; }
node tests/browser/module.mjs target/wasm32-unknown-unknown/wasm/mindgap_browser.wasm "$inputs"
node tests/browser/page.mjs target/npm target/browser/mindgap.html "$inputs" "$pictures"
echo "the page gives the same bytes as the command"
