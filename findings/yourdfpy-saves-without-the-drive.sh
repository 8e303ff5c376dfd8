#!/bin/sh
# yourdfpy 0.0.60: a saved URDF has lost its transmissions, `<gazebo>` plug-ins, ros2_control and soft limits.
#
# Expected: load and save keeps every element, above all `<transmission>`, which the library's own classes describe.
# Happens: only links, joints and materials are written. There is no warning, and the file is valid.
# Met by: anyone who patches a wheel radius or an axle in Python: the simulator then loads a robot that nothing drives.
# Seen: of transmission, gazebo, ros2_control and safety_controller none is left; link and joint are.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check yourdfpy==0.0.60
cd "$dir"
venv/bin/python - <<'END'
import logging
import xml.etree.ElementTree as ET
import yourdfpy

logging.disable(logging.WARNING)
with open("robot.urdf", "w") as file:
    file.write("""<robot name="r"><link name="base"/><link name="wheel"/>
<joint name="axle" type="continuous"><parent link="base"/><child link="wheel"/><axis xyz="0 1 0"/>
<safety_controller k_velocity="1" k_position="10" soft_lower_limit="-1" soft_upper_limit="1"/></joint>
<transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="axle"/>
<actuator name="m"><mechanicalReduction>50</mechanicalReduction></actuator></transmission>
<gazebo><plugin name="drive" filename="libdrive.so"><wheel_separation>0.3</wheel_separation></plugin></gazebo>
<ros2_control name="c" type="system"><hardware><plugin>demo/Hardware</plugin></hardware></ros2_control></robot>""")
yourdfpy.URDF.load("robot.urdf", load_meshes=False, build_scene_graph=False).write_xml_file("saved.urdf")

def tags(path):
    return {element.tag for element in ET.parse(path).iter()}

watched = {"link", "joint", "transmission", "gazebo", "ros2_control", "safety_controller"}
lost = sorted((tags("robot.urdf") & watched) - tags("saved.urdf"))
print("lost:", lost)
if lost != ["gazebo", "ros2_control", "safety_controller", "transmission"]:
    raise SystemExit("the behaviour changed")
END
