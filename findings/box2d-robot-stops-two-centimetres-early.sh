#!/bin/sh
# Box2D 2.3.10 (Python): a robot of 10 cm stops 2 cm in front of the wall; how far depends on the robot's shape.
#
# Expected: shapes given in metres touch where their outlines meet, to a millimetre or so.
# Happens: every polygon has a skin of 1 cm outside its outline, so two of them stop 2 cm apart; a round robot stops 0.8 cm
# away. Rays ignore the skin and see the gap.
# Met by: anyone who simulates a desk robot in metres: a bumper never meets the wall, and a front sonar reads 2 cm in
# contact. An offset of 2 cm against the real robot's sonar is then the engine's.
# Seen: gap of a box 2.0 cm, of a disc 0.8 cm.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check Box2D==2.3.10
cd "$dir"
venv/bin/python - <<'END'
from Box2D import b2PolygonShape, b2World

def gap_cm(round_robot):
    world = b2World(gravity=(0, 0))
    world.CreateStaticBody(position=(1.05, 0), shapes=b2PolygonShape(box=(0.05, 1)))
    robot = world.CreateDynamicBody()
    if round_robot:
        robot.CreateCircleFixture(radius=0.05, density=1)
    else:
        robot.CreatePolygonFixture(box=(0.05, 0.05), density=1)
    for _ in range(400):
        robot.linearVelocity = (0.3, 0)
        world.Step(0.01, 8, 3)
    return round(100 * (1.0 - robot.position.x - 0.05), 1)

box, disc = gap_cm(False), gap_cm(True)
print(f"gap of a box {box} cm, of a disc {disc} cm")
if (box, disc) != (2.0, 0.8):
    raise SystemExit("the behaviour changed")
END
