#!/bin/sh
# importRosbag 1.0.4: the name of the child frame of a TransformStamped is read as part of its position.
#
# Expected: position and quaternion of a recorded pose are those that were written, and every quaternion has w first: the
# README states that this order applies to all message types with a rotation.
# Happens: the reader skips the name of the parent frame but not that of the child, so all seven numbers are read too early.
# A name of four letters shifts them by one place, most other names cut through them. No error is raised. Separately, the
# quaternion of an Imu message keeps w last.
# Met by: everyone who reads a motion-capture reference (vicon_bridge publishes TransformStamped) without an installation of
# ROS, or compares the heading of a PoseStamped with that of the robot's IMU.
# Seen: position (1, 2, 0) comes as (5e+180, 1, 2) for child "base" and as (5e+180, 2.3e-312, 1.4e-312) for "base_link". The
# file is correct: rosbags reads (1, 2, 0). A quaternion with w 0.8 and z 0.6 comes as (0.8, 0, 0, 0.6) from a PoseStamped,
# as (0, 0, 0.6, 0.8) from an Imu.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check importRosbag==1.0.4 rosbags==0.11.9 numpy==2.4.6 \
  setuptools==80.9.0
cd "$dir"
venv/bin/python - <<'END'
import struct
from importRosbag.importRosbag import importRosbag
from rosbags.rosbag1 import Reader, Writer
from rosbags.typesys import Stores, get_typestore

def text(name):
    return struct.pack("<I", len(name)) + name.encode()

def numbers(*values):
    return struct.pack(f"<{len(values)}d", *values)

header = struct.pack("<3I", 0, 1700000000, 0) + text("world")
place, turned = (1.0, 2.0, 0.0), (0.0, 0.0, 0.6, 0.8)
covariance = (0.0,) * 9
messages = {
    "/base": ("geometry_msgs/msg/TransformStamped", header + text("base") + numbers(*place, *turned)),
    "/base_link": ("geometry_msgs/msg/TransformStamped", header + text("base_link") + numbers(*place, *turned)),
    "/pose": ("geometry_msgs/msg/PoseStamped", header + numbers(*place, *turned)),
    "/imu": ("sensor_msgs/msg/Imu", header + numbers(*turned, *covariance, *place, *covariance, *place, *covariance)),
}
store = get_typestore(Stores.ROS1_NOETIC)
with Writer("run.bag") as bag:
    for topic, (kind, raw) in messages.items():
        bag.write(bag.add_connection(topic, kind, typestore=store), 1700000000 * 10**9, raw)

with Reader("run.bag") as bag:
    for connection, _, raw in bag.messages():
        if connection.topic.startswith("/base"):
            moved = store.deserialize_ros1(raw, connection.msgtype).transform.translation
            print(f"{connection.topic}: rosbags reads ({moved.x:g}, {moved.y:g}, {moved.z:g})")

got = importRosbag("run.bag", disable_bar=True)
places = {topic: [float(f"{value:.1e}") for value in got[topic]["point"][0]] for topic in ("/base", "/base_link", "/pose")}
turns = {"/pose": got["/pose"]["rotation"][0].tolist(), "/imu": got["/imu"]["rotQ"][0].tolist()}
print("importRosbag, positions:  ", places)
print("importRosbag, quaternions:", turns)
expected_places = {"/base": [5.0e180, 1.0, 2.0], "/base_link": [5.0e180, 2.3e-312, 1.4e-312], "/pose": [1.0, 2.0, 0.0]}
expected_turns = {"/pose": [0.8, 0.0, 0.0, 0.6], "/imu": [0.0, 0.0, 0.6, 0.8]}
if (places, turns) != (expected_places, expected_turns):
    raise SystemExit("the behaviour changed")
END
