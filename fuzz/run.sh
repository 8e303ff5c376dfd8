#!/usr/bin/env bash
# Fuzzes every target in turn with libFuzzer: fuzz/run.sh HOURS [SECONDS-EACH]. It stops early when an input panics or takes
# over a second, or when a target uses more than 256 MB, and prints the path of the input. Inputs that reach new code are
# kept in target/fuzz/corpus, and the number of inputs per target in target/fuzz/counts; remove that folder to start again.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { echo "fuzz/run.sh HOURS [SECONDS-EACH]" >&2; exit 2; }
until=$(awk -v hours="$1" -v now="$(date +%s)" 'BEGIN { printf "%d", now + 3600 * hours }')
each=${2:-60}
out=target/fuzz
mkdir -p $out/corpus $out/counts $out/found

# The instrumentation of `cargo fuzz`, which stable Rust also supports. With --target, build scripts and macros have none.
flags='--cfg fuzzing -Ccodegen-units=1 -Cpasses=sancov-module'
for option in level=4 inline-8bit-counters pc-table trace-compares; do
    flags+=" -Cllvm-args=-sanitizer-coverage-$option"
done
host=$(rustc -vV | sed -n 's/^host: //p')
RUSTFLAGS=$flags cargo build --quiet --profile fuzz -p mindgap-fuzz --features libfuzzer,libfuzzer-sys/link_libfuzzer --target "$host" --target-dir $out/build

TMPDIR=$(mktemp -d -p "$([ -d /dev/shm ] && echo /dev/shm || echo /tmp)")
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT

# feed TARGET: fuzzes a target for a while and keeps the last figures of libFuzzer's output.
feed() {
    local log=$out/$1.log
    mkdir -p $out/corpus/"$1"
    if ! $out/build/"$host"/fuzz/fuzz $out/corpus/"$1" fuzz/corpus/"$1" -max_total_time="$each" -max_len=8192 -timeout=1 \
        -rss_limit_mb=256 -print_final_stats=1 -artifact_prefix=$out/found/"$1"- 2>"$log"; then
        tail -40 "$log" >&2
        exit 1
    fi
    awk '$1 == "stat::number_of_executed_units:" { inputs = $2 }
         $1 == "stat::peak_rss_mb:" { memory = $2 }
         / cov: / { for (i = 1; i < NF; i++) if ($i == "cov:") edges = $(i + 1) }
         END { print inputs, edges, memory }' "$log" >>$out/counts/"$1"
}

while :; do
    for folder in fuzz/corpus/*/; do
        feed "$(basename "$folder")"
    done
    for counts in $out/counts/*; do
        awk -v name="$(basename "$counts")" '{ inputs += $1; edges = $2; if ($3 > memory) memory = $3 }
            END { printf "%-16s %12d inputs, %6d edges covered, at most %3d MB\n", name, inputs, edges, memory }' "$counts"
    done
    cat $out/counts/* | awk '{ inputs += $1 } END { printf "%d inputs in total\n", inputs }'
    [ "$(date +%s)" -lt "$until" ] || break
done
