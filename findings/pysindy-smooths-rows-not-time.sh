#!/bin/sh
# pysindy 2.1.0: the smoothed derivative of a robot at constant speed varies 150-fold if rows come at irregular times.
#
# Expected: `SmoothedFiniteDifference` is given the time of each row, so a straight ramp of 2 m/s without any noise has a
# derivative of 2 everywhere, as `FiniteDifference` says.
# Happens: the filter smooths over row numbers as if rows were equally spaced, and only the division uses the times. The
# ramp is bent at each change of the step, and speeds between 0.03 and 5.2 m/s come out. Nothing is reported.
# Met by: anyone who identifies a drive from a bag or camera log, whose rows never come at equal steps, and follows the
# advice to smooth noisy data.
# Seen: FiniteDifference 2.00 to 2.00, SmoothedFiniteDifference 0.03 to 5.16 m/s.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check pysindy==2.1.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'END'
import numpy as np
import pysindy

times = np.cumsum(np.random.default_rng(1).choice([0.05, 0.1, 0.2], 100))
position = (2 * times)[:, None]

def speeds(method):
    found = method(position, times)
    return float(found.min()), float(found.max())

plain, smoothed = speeds(pysindy.FiniteDifference()), speeds(pysindy.SmoothedFiniteDifference())
print("speeds of a robot at 2 m/s: plain %.2f to %.2f, smoothed %.2f to %.2f" % (plain + smoothed))
if not (abs(plain[0] - 2) < 1e-6 and abs(plain[1] - 2) < 1e-6 and smoothed[0] < 0.1 and smoothed[1] > 5):
    raise SystemExit("the behaviour changed")
END
