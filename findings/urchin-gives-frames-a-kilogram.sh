#!/bin/sh
# urchin 0.0.30: loading and saving a URDF gives each massless frame 1 kg and 1 kg m^2.
#
# Expected: a link without `<inertial>`, such as a sensor frame or `base_footprint`, is saved without one.
# Happens: the saved file has an `<inertial>` of 1 kg with a unit inertia there. The file is larger but looks right, and
# each simulator reads it in the same way: a robot of 1.2 kg with two frames now weighs 3.2 kg.
# Met by: anyone who edits a number of a robot's description from Python and writes the file again.
# Seen: 1.2 kg before, 3.2 kg after.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check urchin==0.0.30
cd "$dir"
venv/bin/python - <<'END'
import xml.etree.ElementTree as ET
import urchin

with open("robot.urdf", "w") as file:
    file.write("""<robot name="r"><link name="base_footprint"/><link name="chassis"><inertial><mass value="1.2"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="sonar"/>
<joint name="a" type="fixed"><parent link="base_footprint"/><child link="chassis"/></joint>
<joint name="b" type="fixed"><parent link="chassis"/><child link="sonar"/></joint></robot>""")
urchin.URDF.load("robot.urdf").save("saved.urdf")

def mass_kg(path):
    return round(sum(float(mass.get("value")) for mass in ET.parse(path).iter("mass")), 6)

before, after = mass_kg("robot.urdf"), mass_kg("saved.urdf")
print(f"{before} kg before, {after} kg after")
if (before, after) != (1.2, 3.2):
    raise SystemExit("the behaviour changed")
END
