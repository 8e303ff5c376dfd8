#!/bin/sh
# c3d 0.6.0 with ezc3d 1.7.2: a motion capture of twelve minutes read by ezc3d ends with 16 frames at the origin.
#
# Expected: 70,000 frames written by one library are 70,000 frames in the other. The format's 16-bit frame count is too
# small for them, but a parameter with the full count exists, and it is in the file.
# Happens: from 65,535 frames on, ezc3d takes the number of frames from the size of the file. Files are padded to blocks of
# 512 bytes, so the padding becomes frames in which the marker lies exactly at (0, 0, 0) and counts as seen.
# Met by: anyone who records a robot at 100 Hz for longer than 10 min 55 s. The track jumps to the origin at its end, like a
# tracker that lost and found its marker.
# Seen: 70,000 frames by c3d, 70,016 by ezc3d, the last 16 at the origin; 60,000 by both for a shorter one.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check c3d==0.6.0 ezc3d==1.7.2 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'END'
import warnings
import c3d
import ezc3d
import numpy as np

warnings.filterwarnings("ignore")

def frames(count):
    writer = c3d.Writer(point_rate=100, analog_rate=100)
    writer.set_point_labels(["ROBOT"])
    points = np.zeros((count, 1, 5), np.float32)
    points[:, 0, :3] = 500
    writer.add_frames([(point, np.zeros((0, 1), np.float32)) for point in points])
    with open("track.c3d", "wb") as file:
        writer.write(file)
    with open("track.c3d", "rb") as file:
        own = c3d.Reader(file).frame_count
    other = ezc3d.c3d("track.c3d")["data"]["points"][:3, 0]
    return own, other.shape[1], int((other == 0).all(axis=0).sum())

seen = frames(60_000), frames(70_000)
print("frames by c3d, by ezc3d, of these at the origin:", *seen)
if seen != ((60_000, 60_000, 0), (70_000, 70_016, 16)):
    raise SystemExit("the behaviour changed")
END
