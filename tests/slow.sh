#!/usr/bin/env bash
# The long forms of the tests in tests/run.sh, and measurements that check something. Takes several hours on two cores.
#
# tests/run.sh has a short form of each, so a fault that this script finds is usually found there first:
#
#   what                                    in tests/run.sh                           here
#   kills of commands with a checkpoint     2 of evolve, train, make and the loop     200 of all; 20 of calibrate and the demo
#   a loop in two calls                     resumed after kills                       compared with one call as well
#   numbers of ranks                        3                                         1, 2 and 4
#   failing disk calls                      2 per quick command, 1 of the others      every call of quick ones, twice; 8 of the others
#   the demo                                demo --quick: its files and texts         the whole demo: the target is reached
#   cases of another robot                  three of 31                               all
#   changes put into real logs              three and none in the last third          26 in each third, 13 in scans
#   real sonars                             one team                                  all six
#   consoles in the documents               those that are quick                      all
#   controllers through NXC's compiler      24                                        10,000
#   fixed-point functions                   samples                                   every input
#   broken NXT programs                     a few in fuzz/tests                       120 million instructions
#   patched models in MuJoCo and PyBullet   their texts                               driven again
#   fuzz targets                            kept inputs and 1,000 made of them each   libFuzzer, for an hour
#
# tests/run.sh leaves out more samples of the same kind. Each kind of fault and format keeps at least one; kills and failing disks
# of slow commands that work like others, or consist of them, are left out and listed as skipped.
set -euo pipefail
cd "$(dirname "$0")/.."
exec </dev/null
. tests/install.sh
need_all

export MINDGAP_SLOW=1 MINDGAP_DOCS=slow MINDGAP_CONTROLLERS=10000
cargo test --workspace --tests --features mindgap-tests/mpi --no-fail-fast
cargo run --release -p mindgap-tests --example exhaustive-fixed-point
cargo run -p mindgap-tests --example fuzz-brick -- 120 7
fuzz/run.sh 1
two_worlds=${MINDGAP_SHARED:-../shared}/data/two-worlds
if [ -d "$two_worlds" ]; then
    # Both engines, from their packages.
    python3 -m venv target/engines
    target/engines/bin/pip install --quiet mujoco pybullet
    cargo build --release
    target/engines/bin/python tests/engines/two_worlds.py target/release/mindgap "$two_worlds"
else
    echo "skipped: models of two-worlds are not at $two_worlds"
fi
echo "all slow checks passed"
