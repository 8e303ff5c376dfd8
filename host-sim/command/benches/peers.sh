#!/usr/bin/env bash
# Our speed beside other tools', from one run on one machine, everything on one thread: the paper's genetic algorithm on
# a 2-10-1 network with 1000 samples, and a robot with one range sensor among four boxes at control steps of 400 ms.
# Installs what it needs (Debian's g++ and libenki-dev, a Python environment, the crate radiate) and writes every rate
# and the table of ratios.
#   host-sim/command/benches/peers.sh [ROUNDS [RAW.csv TABLE.md]]
set -euo pipefail
cd "$(dirname "$0")/../.."
rounds=${1:-5} raw=${2:-docs/peers.csv} table=${3:-docs/peers.md}
peers=host-sim/command/benches/peers
work=target/peers
export RAYON_NUM_THREADS=1 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
mkdir -p "$work"

if ! dpkg -s g++ libenki-dev python3-venv >/dev/null 2>&1; then
    apt-get update && apt-get install -y g++ libenki-dev python3-venv
fi
[ -x "$work/python/bin/python" ] || python3 -m venv "$work/python"
"$work/python/bin/pip" install --quiet deap==1.4.4 pymoo==0.6.2 pygad==3.9.2
g++ -std=c++17 -O3 "$peers/enki.cpp" -lenki -o "$work/enki"
cargo build --quiet --release --manifest-path "$peers/radiate/Cargo.toml" --target-dir "$work/radiate"
cargo bench --quiet -p mindgap-command --bench speed --no-run

# BENCHMARK [ARGUMENT]: the median throughput of one of our benchmarks, items a second.
ours() {
    cargo bench --quiet -p mindgap-command --bench speed -- "$1" --sample-count 20 2>/dev/null |
        "$work/python/bin/python" "$peers/median.py" "${2:-$1}"
}

echo round,work,tool,per_second >"$raw"
for round in $(seq "$rounds"); do
    for tool in deap pymoo pygad; do
        echo "$round,generation,$tool,$("$work/python/bin/python" "$peers/${tool}_ga.py" 2>/dev/null)"
    done
    echo "$round,generation,radiate,$("$work/radiate/release/radiate-peer")"
    echo "$round,generation,mindgap,$(ours training_generations)"
    echo "$round,step,Enki,$("$work/enki" 1)"
    echo "$round,step,Enki in 8 parts,$("$work/enki" 8)"
    echo "$round,step,mindgap,$(ours robot_steps FiveNetworks)"
    echo "$round,step,mindgap with tabulated motions,$(ours robot_steps Tabulated)"
done | tee -a "$raw"
"$work/python/bin/python" "$peers/table.py" "$raw" | tee "$table"
