#!/usr/bin/env bash
# Feeds every target by libFuzzer, a while each and again, for so many hours: fuzz/run.sh HOURS [SECONDS-EACH]. It ends
# before that where an input panics, takes over a second, or where a target takes more than 256 MB, and says where the input
# lies. Inputs that reach something new are kept in target/fuzz/corpus, and how many inputs each target has had in
# target/fuzz/counts; remove that folder to begin anew.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { echo "fuzz/run.sh HOURS [SECONDS-EACH]" >&2; exit 2; }
until=$(awk -v hours="$1" -v now="$(date +%s)" 'BEGIN { printf "%d", now + 3600 * hours }')
each=${2:-60}
out=target/fuzz
mkdir -p $out/corpus $out/counts $out/found

# The instrumentation of `cargo fuzz`, which stable Rust has too. With a target named, build scripts and macros have none.
flags='--cfg fuzzing -Ccodegen-units=1 -Cpasses=sancov-module'
for option in level=4 inline-8bit-counters pc-table trace-compares; do
    flags+=" -Cllvm-args=-sanitizer-coverage-$option"
done
host=$(rustc -vV | sed -n 's/^host: //p')
RUSTFLAGS=$flags cargo build --quiet --profile fuzz -p mindgap-fuzz --features libfuzzer,libfuzzer-sys/link_libfuzzer --target "$host" --target-dir $out/build

TMPDIR=$(mktemp -d -p "$([ -d /dev/shm ] && echo /dev/shm || echo /tmp)")
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT

# feed TARGET: for a while. Of what libFuzzer says its last figures are kept.
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
         / cov: / { for (i = 1; i < NF; i++) if ($i == "cov:") places = $(i + 1) }
         END { print inputs, places, memory }' "$log" >>$out/counts/"$1"
}

while :; do
    for folder in fuzz/corpus/*/; do
        feed "$(basename "$folder")"
    done
    for counts in $out/counts/*; do
        awk -v name="$(basename "$counts")" '{ inputs += $1; places = $2; if ($3 > memory) memory = $3 }
            END { printf "%-16s %12d inputs, %6d places reached, at most %3d MB\n", name, inputs, places, memory }' "$counts"
    done
    cat $out/counts/* | awk '{ inputs += $1 } END { printf "%d inputs in all\n", inputs }'
    [ "$(date +%s)" -lt "$until" ] || break
done
