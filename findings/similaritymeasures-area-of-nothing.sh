#!/bin/sh
# similaritymeasures 1.5.0: two logs of the same lap at different rates enclose half of the track's area.
#
# Expected: `area_between_two_curves` of a circle sampled at 100 points and the same circle sampled at 200 is about 0.
# Happens: points are paired by their order after the shorter curve has been filled up, not by their place, and the strips
# between pairs count even where they run along the curve. A straight line shows nothing of it.
# Met by: anyone who scores a simulated path against a tracked one: a tracker at another rate, or the same path at another
# speed, looks like a different path.
# Seen: 0.00 for 100 and 100 points, 0.25 for 137, 1.66 for 200; the disc itself has 3.14.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check similaritymeasures==1.5.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'END'
import numpy as np
from similaritymeasures import area_between_two_curves

def lap(points):
    angle = np.linspace(0, 2 * np.pi, points)
    return np.c_[np.cos(angle), np.sin(angle)]

seen = [round(float(area_between_two_curves(lap(100), lap(points))), 2) for points in (100, 137, 200)]
print("area between a lap of 100 points and the same of 100, 137, 200:", seen)
if seen != [0.0, 0.25, 1.66]:
    raise SystemExit("the behaviour changed")
END
