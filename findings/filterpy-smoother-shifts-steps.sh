#!/bin/sh
# filterpy 2.0.0: the unscented smoother is one row off in the time steps of an irregular log.
#
# Expected: `UnscentedKalmanFilter.rts_smoother(means, covariances, dts=dts)` takes the list that `batch_filter(zs,
# dts=dts)` took, and returns what `KalmanFilter.rts_smoother` returns where the model is linear.
# Happens: `batch_filter` uses dts[k] for the step that ends at row k, the smoother for the step that starts there. A robot
# at exactly 1 m/s, tracked without noise, is smoothed to positions up to 27 cm off. With equal steps nobody notices.
# Met by: anyone who smooths a track of a camera or a bag whose rows come at 50, 100 and 400 ms.
# Seen: filters differ by less than 1 nm; error of the linear smoother 0.000 m, of the unscented one 0.267 m, with the list
# shifted by one row 0.000 m.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check filterpy==2.0.0 numpy==2.4.6 scipy==1.17.1
cd "$dir"
venv/bin/python - <<'END'
import numpy as np
from filterpy.kalman import KalmanFilter, MerweScaledSigmaPoints, UnscentedKalmanFilter

dts = np.random.default_rng(0).choice([0.05, 0.1, 0.4], 60)
track = np.cumsum(dts)
F = lambda dt: np.array([[1.0, dt], [0.0, 1.0]])
Q = np.eye(2) * 1e-3

unscented = UnscentedKalmanFilter(
    2, 1, 0.1, lambda x: x[:1], lambda x, dt: F(dt) @ x, MerweScaledSigmaPoints(2, 0.5, 2.0, 1.0))
linear = KalmanFilter(2, 1)
linear.H = np.array([[1.0, 0.0]])
for kalman in (unscented, linear):
    kalman.x, kalman.P, kalman.R, kalman.Q = np.array([0.0, 1.0]), np.eye(2), np.eye(1) * 0.01, Q

means, covariances = unscented.batch_filter(track, dts=dts)
Fs = [F(dt) for dt in dts]
linear_means, linear_covariances, _, _ = linear.batch_filter(track, Fs=Fs)
filters_differ = abs(means - linear_means).max()

error = lambda smoothed: abs(smoothed[:, 0] - track).max()
of_linear = error(linear.rts_smoother(linear_means, linear_covariances, Fs=Fs)[0])
of_unscented = error(unscented.rts_smoother(means, covariances, dts=dts)[0])
of_shifted = error(unscented.rts_smoother(means, covariances, dts=np.roll(dts, -1))[0])
print(f"filters differ by {filters_differ:.0e} m; largest error of the linear smoother {of_linear:.3f} m, "
      f"of the unscented one {of_unscented:.3f} m, with steps shifted by a row {of_shifted:.3f} m")
if not (filters_differ < 1e-9 and of_linear < 1e-6 and abs(of_unscented - 0.267) < 0.001 and of_shifted < 1e-6):
    raise SystemExit("the behaviour changed")
END
