#!/bin/sh
# MicroPython 1.27.0 (npm @micropython/micropython-webassembly-pyscript 1.27.0): a reading that does not fit is stored as
# another one.
#
# Expected: a byte array, a typed array or `struct.pack` raises an error for a number out of range, as Python does.
# Happens: the number is cut to its low bits without an error.
# Met by: anyone who logs on a MicroPython brick or board into a compact buffer: an echo at 300 cm in a byte becomes 44 cm,
# a wheel angle of 40,000 degrees in 16 bits becomes -25,536. A test of the same lines on a desk raises an error.
# Seen: bytearray 44, array('B') 44, array('h') -25536, struct.pack('<h') -25536; OverflowError or ValueError in CPython.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
cd "$dir"
npm install --silent --no-fund --no-audit @micropython/micropython-webassembly-pyscript@1.27.0
cat >log.py <<'END'
import struct
from array import array

def stored(action):
    try:
        return action()
    except (OverflowError, ValueError, struct.error):
        return "error"

print(stored(lambda: bytearray([300])[0]), stored(lambda: array("B", [300])[0]), stored(lambda: array("h", [40000])[0]),
      stored(lambda: struct.unpack("<h", struct.pack("<h", 40000))[0]))
END
cat >run.mjs <<'END'
import { readFileSync } from "node:fs";
import { loadMicroPython } from "@micropython/micropython-webassembly-pyscript/micropython.mjs";
const micropython = await loadMicroPython({ stdout: (line) => console.log(line) });
micropython.runPython(readFileSync("log.py", "utf8"));
END
board=$(node run.mjs)
desk=$(python3 log.py)
echo "MicroPython: $board; CPython: $desk"
if [ "$board" != "44 44 -25536 -25536" ] || [ "$desk" != "error error error error" ]; then
    echo "the behaviour changed" >&2
    exit 1
fi
