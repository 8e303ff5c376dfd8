"""Reads divan's report and prints the median throughput of one benchmark, items a second."""

import re
import sys

name, lines = sys.argv[1], sys.stdin.read().splitlines()
UNITS = {"item/s": 1, "Kitem/s": 1e3, "Mitem/s": 1e6, "Gitem/s": 1e9}
for i, line in enumerate(lines):
    if re.search(rf"[─ ]{name} +[0-9]", line):
        value, unit = lines[i + 1].split("│")[-4].split()
        print(float(value) * UNITS[unit])
        break
else:
    sys.exit(f"divan reports no benchmark {name}")
