#!/bin/sh
# simple-pid 2.0.1: a controller that is called with a step below its sample time never changes its output again.
#
# Expected: with `sample_time` at 10 ms and `pid(measured, dt=0.005)` at each step, the output is renewed at every second
# call.
# Happens: each step is compared with the sample time on its own and the steps are not added up, so the first output is
# returned for ever: the wheel speed passes its target and the controller still demands full power.
# Met by: anyone who runs the brick's controller in a simulator with physics steps of 1 to 5 ms. `dt` is the documented way
# to run faster than real time.
# Seen: 200 calls with dt = 5 ms give one distinct output, with dt = 10 ms 200.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check simple-pid==2.0.1
cd "$dir"
venv/bin/python - <<'END'
from simple_pid import PID

def outputs(dt_s):
    pid = PID(1.0, 0.0, 0.0, setpoint=1.0, sample_time=0.01)
    speed, given = 0.0, []
    for _ in range(200):
        given.append(pid(speed, dt=dt_s))
        speed += dt_s * given[-1] * 2.0
    return len(set(given)), speed

(short, speed), (equal, _) = outputs(0.005), outputs(0.01)
print(f"distinct outputs of 200 calls: {short} at 5 ms (speed ends at {speed:.2f} for a target of 1), {equal} at 10 ms")
if (short, equal) != (1, 200):
    raise SystemExit("the behaviour changed")
END
