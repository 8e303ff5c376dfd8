#!/bin/sh
# pymunk 7.3.1: a ray that starts inside a shape reports a hit at distance 0 and, in the same result, at its far end.
#
# Expected: a query from a point within the robot's own body gives alpha 0 with the start as the point of contact, or no
# hit.
# Happens: alpha is 0, but `point` is the end of the ray. A range taken from `alpha` is 0 m, one taken from `point` is the
# sensor's full range.
# Met by: anyone who mounts a simulated sonar inside the chassis, and anyone whose robot pushes into a wall: read by
# `point`, the wall in contact is "nothing within 2 m".
# Seen: alpha 0.0, point (2.0, 0.0) for a ray from (0, 0) to (2, 0).
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check pymunk==7.3.1
cd "$dir"
venv/bin/python - <<'END'
import pymunk

space = pymunk.Space()
robot = pymunk.Body(1, 1)
space.add(robot, pymunk.Poly.create_box(robot, (0.1, 0.1)))
hit = space.segment_query_first((0, 0), (2, 0), 0, pymunk.ShapeFilter())
print(f"alpha {hit.alpha}, point {tuple(hit.point)}")
if (hit.alpha, tuple(hit.point)) != (0.0, (2.0, 0.0)):
    raise SystemExit("the behaviour changed")
END
