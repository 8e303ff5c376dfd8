"""Turns the raw rates into a table: medians over the rounds, and our rate as a multiple of each."""

import csv
import statistics
import sys
from pathlib import Path

WORKS = {
    "generation": "a generation of the paper's genetic algorithm, 2-10-1 network, 1000 samples",
    "step": "a robot's control step of 400 ms among four boxes",
}
rates = {}
for row in csv.DictReader(open(sys.argv[1], encoding="utf-8")):
    rates.setdefault(row["work"], {}).setdefault(row["tool"], []).append(float(row["per_second"]))
cpu = next(line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("flags"))
model = next(line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name"))
widest = "AVX-512" if "avx512f" in cpu else "AVX2" if "avx2" in cpu else "neither AVX2 nor AVX-512"

print("# Beside other tools\n")
print(f"`host-sim/command/benches/peers.sh`, one thread, {model.split(':')[1].strip()} with {widest};")
rounds, raw = max(len(v) for v in rates["step"].values()), Path(sys.argv[1]).name
print(f"medians of {rounds} rounds in turn; raw: [{raw}]({raw}).\n")
for work, tools in rates.items():
    medians = {tool: statistics.median(values) for tool, values in tools.items()}
    ours = {tool: rate for tool, rate in medians.items() if tool.startswith("mindgap")}
    print(f"| {WORKS[work]} | per second |" + "".join(f" {tool} is faster by |" for tool in ours))
    print("| --- | --- |" + " --- |" * len(ours))
    for tool, rate in medians.items():
        ratios = "".join(f" {own / rate:.1f} |" if tool not in ours else " |" for own in ours.values())
        print(f"| {tool} | {rate:,.0f} |{ratios}")
    print()
print(Path(__file__).with_name("notes.md").read_text(encoding="utf-8").strip())
