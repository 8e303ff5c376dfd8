#!/bin/sh
# ahrs 0.4.0: filters of one library turn the same robot left, right or not at all.
#
# Expected: the gyroscope reports +90 degrees/s about the vertical for one second, on a level robot; the attitude filters
# differ a little, and the heading grows by about 90 degrees in all of them.
# Happens: AQUA and ROLEQ return the inverse rotation, so the heading falls by 90. Complementary without a magnetometer
# returns a heading of 0 throughout: the gyroscope's turn is discarded.
# Met by: anyone who compares filters on an IMU log to get a heading for a wheeled robot, and swaps one class for another.
# Seen: Madgwick 90, Mahony 90, EKF 90, AngularRate 90, Complementary 0, AQUA -90, ROLEQ -90.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check ahrs==0.4.0 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'END'
import numpy as np
from ahrs import filters

rows = 101
gyr = np.zeros((rows, 3))
gyr[1:, 2] = np.pi / 2
acc = np.tile([0.0, 0.0, 9.81], (rows, 1))
turned = np.cumsum(gyr[:, 2]) * 0.01
mag = np.c_[20 * np.cos(turned), -20 * np.sin(turned), np.full(rows, 40.0)]

def heading_deg(q):
    w, x, y, z = q
    return np.degrees(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))

logs = {"AngularRate": {"gyr": gyr}, "ROLEQ": {"gyr": gyr, "acc": acc, "mag": mag}}
expected = {"Madgwick": 90, "Mahony": 90, "EKF": 90, "AngularRate": 90, "Complementary": 0, "AQUA": -90, "ROLEQ": -90}
seen = {}
for name in expected:
    log = logs.get(name, {"gyr": gyr, "acc": acc})
    attitudes = getattr(filters, name)(frequency=100.0, q0=np.array([1.0, 0.0, 0.0, 0.0]), **log).Q
    seen[name] = round(float(heading_deg(attitudes[-1]) - heading_deg(attitudes[0])))
print(", ".join(f"{name} {angle}" for name, angle in seen.items()))
if seen != expected:
    raise SystemExit("the behaviour changed")
END
