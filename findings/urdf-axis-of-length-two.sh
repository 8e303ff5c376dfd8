#!/bin/sh
# yourdfpy 0.0.60 and ikpy 4.2.1 against pytransform3d 3.17.0 and mujoco 4.0.0: a joint axis that is not a unit vector
# stretches the robot in some readers.
#
# Expected: every reader of URDF scales `<axis xyz="1 1 0"/>` to length one, or refuses it.
# Happens: a slide along "0 0 2" by 0.5 m moves the link by 1 m in yourdfpy and ikpy and by 0.5 m in the others, without a
# message. In ikpy a hinge about "0 0 2" also enlarges everything behind it: the determinant of its rotation is 2.3.
# Met by: anyone who checks a lift or a diagonal slide in one library and simulates it in another; CAD exports and
# hand-written diagonals have such axes.
# Seen: 1.0 m in yourdfpy and ikpy, 0.5 m in pytransform3d and mujoco; determinant of the hinge in ikpy 2.31.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check \
    yourdfpy==0.0.60 ikpy==4.2.1 pytransform3d==3.17.0 mujoco==4.0.0
cd "$dir"
venv/bin/python - <<'END'
import logging, warnings
import numpy as np

warnings.filterwarnings("ignore")
logging.disable(logging.WARNING)
INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
URDF = f"""<robot name="r"><link name="base">{INERTIAL}</link><link name="tip">{INERTIAL}</link>
<joint name="j" type="KIND"><parent link="base"/><child link="tip"/><axis xyz="0 0 2"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"""

def by_yourdfpy(text):
    import yourdfpy
    robot = yourdfpy.URDF.load("r.urdf", load_meshes=False)
    robot.update_cfg([0.5])
    return robot.get_transform("tip", "base")

def by_ikpy(text):
    from ikpy.chain import Chain
    return Chain.from_urdf_file("r.urdf", base_elements=["base"]).forward_kinematics([0, 0.5])

def by_pytransform3d(text):
    from pytransform3d.urdf import UrdfTransformManager
    robot = UrdfTransformManager()
    robot.load_urdf(text)
    robot.set_joint("j", 0.5)
    return robot.get_transform("tip", "base")

def by_mujoco(text):
    import mujoco
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[:] = 0.5
    mujoco.mj_kinematics(model, data)
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = data.body("tip").xmat.reshape(3, 3), data.body("tip").xpos
    return transform

def pose(reader, kind):
    text = URDF.replace("KIND", kind)
    with open("r.urdf", "w") as file:
        file.write(text)
    return np.asarray(reader(text))

readers = [by_yourdfpy, by_ikpy, by_pytransform3d, by_mujoco]
slides = {r.__name__[3:]: round(float(pose(r, "prismatic")[2, 3]), 3) for r in readers}
volume = round(float(np.linalg.det(pose(by_ikpy, "revolute")[:3, :3])), 2)
print(slides, "hinge in ikpy:", volume)
if slides != {"yourdfpy": 1.0, "ikpy": 1.0, "pytransform3d": 0.5, "mujoco": 0.5} or volume != 2.31:
    raise SystemExit("the behaviour changed")
END
