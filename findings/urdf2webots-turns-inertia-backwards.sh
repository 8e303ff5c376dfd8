#!/bin/sh
# urdf2webots 2025.0.0: an inertia whose frame is turned by +45 degrees arrives in Webots turned by -45 degrees.
#
# Expected: the matrix in the PROTO file is that of the URDF after the turn in the inertial origin, as MuJoCo reads it from
# the same file.
# Happens: the matrix is turned the other way, so the product of inertia has the opposite sign. Mass and centre of mass are
# correct. A diagonal matrix that is turned by a multiple of 90 degrees about one axis is correct too, which hides the fault.
# Met by: everyone whose CAD exporter writes principal axes (a diagonal matrix and a turned origin), and everyone who compares
# a robot in Webots with the same robot in another simulator.
# Seen: for a rod along the diagonal of x and y, Ixy is +0.0045 kg m2 in the PROTO file and -0.0045 in MuJoCo: the rod lies
# along the other diagonal.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check urdf2webots==2025.0.0 mujoco==4.0.0 numpy==2.4.6
cd "$dir"
cat > robot.urdf <<'END'
<robot name="robot">
  <link name="base"><inertial>
    <mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
  </inertial></link>
  <joint name="joint" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 0 1"/></joint>
  <link name="rod"><inertial>
    <origin rpy="0 0 0.785398163397"/>
    <mass value="1"/><inertia ixx="0.001" iyy="0.01" izz="0.0105" ixy="0" ixz="0" iyz="0"/>
  </inertial></link>
</robot>
END
venv/bin/python -m urdf2webots.importer --input=robot.urdf --output=Robot.proto > import.txt
venv/bin/python - <<'END'
import re
import mujoco
import numpy as np

rod = open("Robot.proto").read().split('name "rod"')[1]
diagonal, products = re.search(r"inertiaMatrix \[\s*(.*)\s*(.*)", rod).groups()
webots = [round(float(number), 4) for number in (diagonal.split()[0], products.split()[0])]
model = mujoco.MjModel.from_xml_path("robot.urdf")
turn = np.zeros(9)
mujoco.mju_quat2Mat(turn, model.body_iquat[-1])
turn = turn.reshape(3, 3)
matrix = turn @ np.diag(model.body_inertia[-1]) @ turn.T
reference = [round(float(number), 4) for number in matrix[0, :2]]
print("Ixx and Ixy of the rod (kg m2): urdf2webots", webots, "mujoco", reference)
if (webots, reference) != ([0.0055, 0.0045], [0.0055, -0.0045]):
    raise SystemExit("the behaviour changed")
END
