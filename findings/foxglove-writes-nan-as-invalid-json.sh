#!/bin/sh
# foxglove-sdk 0.30.3: a reading that is not a number makes the message invalid JSON.
#
# Expected: `foxglove.log("/range", {"range": nan})` raises an error, or writes null.
# Happens: the recorder writes the bare word NaN (or Infinity) into a message that the file declares as JSON, and closes the
# file without a warning. JSON has no such words: a strict reader rejects these rows. Python's own reader accepts them, so a
# check in Python passes.
# Met by: anyone who logs a range sensor: "no echo" is NaN or infinity in ROS and in most drivers.
# Seen: {"range": NaN} and {"range": Infinity} in the file, both rejected by a strict reader.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check foxglove-sdk==0.30.3 mcap==1.6.0
cd "$dir"
venv/bin/python - <<'END'
import json
import foxglove
from mcap.reader import make_reader

def strict(text):
    def reject(word):
        raise ValueError(word)
    json.loads(text, parse_constant=reject)

with foxglove.open_mcap("ranges.mcap"):
    for k, reading in enumerate([0.25, float("nan"), float("inf")]):
        foxglove.log("/range", {"range": reading}, log_time=k + 1)
seen = []
with open("ranges.mcap", "rb") as file:
    for _, channel, message in make_reader(file).iter_messages():
        try:
            strict(message.data)
            verdict = "valid"
        except ValueError:
            verdict = "invalid"
        seen.append((channel.message_encoding, message.data.decode(), verdict))
print(seen)
if seen != [("json", '{"range": 0.25}', "valid"), ("json", '{"range": NaN}', "invalid"),
            ("json", '{"range": Infinity}', "invalid")]:
    raise SystemExit("the behaviour changed")
END
