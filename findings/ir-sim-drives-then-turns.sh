#!/bin/sh
# ir-sim 2.12.0: a differential drive moves along its old heading in each step, so its arcs end in the wrong place.
#
# Expected: wheel speeds that are constant over a step give an arc: after one second at 1 m/s and 90 degrees/s the robot is
# at (0.637, 0.637) m from its start.
# Happens: the step is driven straight, and the heading changes afterwards. The heading is right, but the position is 7 cm
# off after 1 m of path, to the outside. At the usual step of 100 ms the error is 8 % of the displacement.
# Met by: anyone who takes logs of this simulator for ground truth: against exact arcs the direction of travel lags the
# heading by half a step.
# Seen: (0.685, 0.585) m, heading 90.0 degrees.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check ir-sim==2.12.0 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'END'
import contextlib, io, math
import numpy as np

with open("world.yaml", "w") as file:
    file.write("""world: {height: 10, width: 10, step_time: 0.1, sample_time: 0.1}
robot:
  - kinematics: {name: 'diff'}
    shape: {name: 'circle', radius: 0.1}
    state: [5, 5, 0]
    goal: [9, 9, 0]
    vel_min: [-3, -7]
    vel_max: [3, 7]
""")
with contextlib.redirect_stdout(io.StringIO()):
    import irsim
    env = irsim.make("world.yaml", display=False)
    for _ in range(10):
        env.step(np.array([1.0, math.pi / 2]))
    x, y, heading = (float(v) for v in env.robot.state.ravel()[:3])
seen = (round(x - 5, 3), round(y - 5, 3), round(math.degrees(heading), 1))
print("moved by %.3f, %.3f m, heading %.1f degrees; the arc ends at 0.637, 0.637" % seen)
if seen != (0.685, 0.585, 90.0):
    raise SystemExit("the behaviour changed")
END
