#!/bin/sh
# mujoco 4.0.0: a saved model has six digits per number, so what stands far from the origin moves by millimetres.
#
# Expected: `MjSpec.to_xml()` and `mj_saveLastXML` write numbers that load as the same model.
# Happens: every number is rounded to six significant digits, and neither function has an option for more. A charging dock
# at x = 1234.56789 m moves by 2 mm, and a fitted wheel radius loses its last digits.
# Met by: anyone who corrects a model by a program and saves it, or checks that loading, saving and loading give the same
# rollout. It does not.
# Seen: 1234.56789 saved as 1234.57, a radius of 0.0278123456 as 0.0278123, by both functions.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check mujoco==4.0.0 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'END'
import mujoco

xml = """<mujoco><worldbody><body name="dock" pos="1234.56789 0 0"><joint type="slide"/>
<geom type="sphere" size="0.0278123456" mass="1"/></body></worldbody></mujoco>"""
spec = mujoco.MjSpec.from_string(xml)
spec.compile()
model = mujoco.MjModel.from_xml_string(xml)
mujoco.mj_saveLastXML("saved.xml", model)
again = [mujoco.MjModel.from_xml_string(spec.to_xml()), mujoco.MjModel.from_xml_path("saved.xml")]
seen = [(float(m.body("dock").pos[0]), float(m.geom_size[0, 0])) for m in [model, *again]]
print(seen)
if seen != [(1234.56789, 0.0278123456), (1234.57, 0.0278123), (1234.57, 0.0278123)]:
    raise SystemExit("the behaviour changed")
END
