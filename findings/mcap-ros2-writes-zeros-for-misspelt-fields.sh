#!/bin/sh
# mcap-ros2-support 0.6.0: fields that the message does not have are dropped, and its own become zero.
#
# Expected: writing a Twist from a dictionary with a field of another name raises an error, as a number out of range does.
# So does an array of fixed length with too many or too few numbers.
# Happens: the unknown name is ignored and zero is written in place of the right one; a long array is cut; a short one is
# filled up with zeros, in the caller's own list as well, which afterwards has `None` in it.
# Met by: anyone who converts CSV or brick logs to a bag. The bag is valid, and the robot of the bag stands still.
# Seen: linear.x 0.0 for {"X": 0.3}, angular.z 0.0 for {"angle": ...}; [1, 2, 3] in float64[2] read as [1.0, 2.0], [7] as
# [7.0, 0.0] with [7, None] left in the program.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check mcap==1.6.0 mcap-ros2-support==0.6.0
cd "$dir"
venv/bin/python - <<'END'
import io
from mcap_ros2.reader import read_ros2_messages
from mcap_ros2.writer import Writer

VECTOR = "=" * 80 + "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
TWIST = "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n" + VECTOR

def through_a_bag(kind, definition, message):
    bag = io.BytesIO()
    writer = Writer(bag)
    schema = writer.register_msgdef(kind, definition)
    writer.write_message(topic="/t", schema=schema, message=message, log_time=1, publish_time=1)
    writer.finish()
    bag.seek(0)
    return next(iter(read_ros2_messages(bag))).ros_msg

twist = through_a_bag("geometry_msgs/msg/Twist", TWIST, {"linear": {"X": 0.3}, "angle": {"z": 0.5}})
long = through_a_bag("demo_msgs/msg/Pair", "float64[2] pair", {"pair": [1, 2, 3]})
mine = [7]
short = through_a_bag("demo_msgs/msg/Pair", "float64[2] pair", {"pair": mine})
seen = (twist.linear.x, twist.angular.z, list(long.pair), list(short.pair), mine)
print("linear.x %s, angular.z %s; three numbers read as %s, one as %s, the program's list is now %s" % seen)
if seen != (0.0, 0.0, [1.0, 2.0], [7.0, 0.0], [7, None]):
    raise SystemExit("the behaviour changed")
END
