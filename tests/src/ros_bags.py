"""Writes the bags that the tests of `mindgap import bag` read, with the official writer of ROS 2 messages."""

import csv
import math
import sys
from pathlib import Path

from mcap.writer import CompressionType
from mcap_ros2.writer import Writer

TIME = "builtin_interfaces/Time stamp\nstring frame_id\n"
HEADER = "=" * 80 + "\nMSG: std_msgs/Header\n" + TIME
STAMP = "=" * 80 + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
VECTOR = "=" * 80 + "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
POINT = "=" * 80 + "\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"
QUATERNION = "=" * 80 + "\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
TWIST = "=" * 80 + "\nMSG: geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"
POSE = "=" * 80 + "\nMSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"
TRANSFORM = (
    "=" * 80
    + "\nMSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"
)
TRANSFORM_STAMPED = (
    "=" * 80
    + "\nMSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n"
    + "geometry_msgs/Transform transform\n"
)
OF_POSE = HEADER + STAMP + POSE + POINT + QUATERNION

SCHEMAS = {
    "geometry_msgs/msg/Twist": "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n" + VECTOR,
    "geometry_msgs/msg/TwistStamped": "std_msgs/Header header\ngeometry_msgs/Twist twist\n" + HEADER + STAMP + TWIST + VECTOR,
    "geometry_msgs/msg/PoseStamped": "std_msgs/Header header\ngeometry_msgs/Pose pose\n" + OF_POSE,
    "nav_msgs/msg/Odometry": "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
    + "geometry_msgs/TwistWithCovariance twist\n"
    + OF_POSE
    + "=" * 80
    + "\nMSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance\n"
    + "=" * 80
    + "\nMSG: geometry_msgs/TwistWithCovariance\ngeometry_msgs/Twist twist\nfloat64[36] covariance\n"
    + TWIST
    + VECTOR,
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms\n"
    + TRANSFORM_STAMPED
    + HEADER
    + STAMP
    + TRANSFORM
    + VECTOR
    + QUATERNION,
    "sensor_msgs/msg/Range": "std_msgs/Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\n"
    + "float32 max_range\nfloat32 range\n"
    + HEADER
    + STAMP,
    "sensor_msgs/msg/JointState": "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
    + "float64[] effort\n"
    + HEADER
    + STAMP,
    "sensor_msgs/msg/Imu": "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
    + "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
    + "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n"
    + "float64[9] linear_acceleration_covariance\n"
    + HEADER
    + STAMP
    + VECTOR
    + QUATERNION,
    "sensor_msgs/msg/LaserScan": "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
    + "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n"
    + "float32[] intensities\n"
    + HEADER
    + STAMP,
}


class Bag:
    """A bag whose messages come in order of time."""

    def __init__(self, path, compression):
        self.writer = Writer(str(path), compression=compression, chunk_size=64 * 1024)
        self.schemas = {}

    def write(self, topic, kind, t_s, message):
        if kind not in self.schemas:
            self.schemas[kind] = self.writer.register_msgdef(kind, SCHEMAS[kind])
        ns = round(t_s * 1e9)
        self.writer.write_message(topic, self.schemas[kind], message, log_time=ns, publish_time=ns)


def header(t_s):
    ns = round(t_s * 1e9)
    return {"stamp": {"sec": ns // 10**9, "nanosec": ns % 10**9}, "frame_id": "map"}


def vector(x, y=0.0, z=0.0):
    return {"x": x, "y": y, "z": z}


def twist(row):
    return {"linear": vector(row["v_m_s"]), "angular": vector(0.0, 0.0, row["w_rad_s"])}


def turned(row):
    return {"x": 0.0, "y": 0.0, "z": row["qz"], "w": row["qw"]}


def pose(row):
    return {"position": vector(row["x_m"], row["y_m"]), "orientation": turned(row)}


def tf(row, parent, child):
    transform = {"translation": vector(row["x_m"], row["y_m"]), "rotation": turned(row)}
    stamped = {"header": {**header(row["t_s"]), "frame_id": parent}, "child_frame_id": child, "transform": transform}
    return {"transforms": [stamped]}


def localised(path, compression, drive):
    """A base that reckons in a frame which a localiser moves now and then, and whose axle is behind its frame."""
    bag = Bag(path, compression)
    shift_m, turn_rad, ahead_m, first_s = (0.5, -0.3), 0.2, 0.1, drive[0]["t_s"]
    still = {"t_s": first_s, "x_m": -ahead_m, "y_m": 0.0, "qz": 0.0, "qw": 1.0}
    bag.write("/tf_static", "tf2_msgs/msg/TFMessage", first_s, tf(still, "torso", "base_link"))
    for index, row in enumerate(drive):
        t_s = row["t_s"]
        bag.write("/cmd_vel", "geometry_msgs/msg/Twist", t_s, twist(row))
        at_m = (shift_m[0] + 0.01 * (t_s - first_s), shift_m[1])
        if index % 10 == 0:
            half = turn_rad / 2
            odom = {"t_s": t_s, "x_m": at_m[0], "y_m": at_m[1], "qz": math.sin(half), "qw": math.cos(half)}
            bag.write("/tf", "tf2_msgs/msg/TFMessage", t_s, tf(odom, "map", "odom"))
        heading = 2 * math.atan2(row["qz"], row["qw"])
        x = row["x_m"] + ahead_m * math.cos(heading) - at_m[0]
        y = row["y_m"] + ahead_m * math.sin(heading) - at_m[1]
        half = (heading - turn_rad) / 2
        torso = {
            "t_s": t_s,
            "x_m": x * math.cos(turn_rad) + y * math.sin(turn_rad),
            "y_m": y * math.cos(turn_rad) - x * math.sin(turn_rad),
            "qz": math.sin(half), "qw": math.cos(half),
        }
        bag.write("/tf", "tf2_msgs/msg/TFMessage", t_s, tf(torso, "odom", "torso"))
    bag.writer.finish()


def scan(row):
    # The beam straight ahead is the third of five, and one beside it sees something nearer.
    ranges = [9.0, 0.5, row["range_m"], 9.0, float("inf")]
    return {
        "header": header(row["t_s"]),
        "angle_min": -1.0, "angle_max": 1.0, "angle_increment": 0.5, "time_increment": 0.0, "scan_time": 0.1,
        "range_min": 0.1, "range_max": 4.0, "ranges": ranges, "intensities": [],
    }


def range_of(row):
    return {
        "header": header(row["t_s"]), "radiation_type": 0, "field_of_view": 0.3, "min_range": 0.05, "max_range": 2.5,
        "range": row["range_m"],
    }


def joints(row):
    """Wheels of 6 cm, 20 cm apart, that turn as the drive does, and a joint that does not belong to the drive."""
    angles = [row["wheel_left_rad"], 0.3, row["wheel_right_rad"]]
    names = ["wheel_left_joint", "camera_joint", "wheel_right_joint"]
    return {"header": header(row["t_s"]), "name": names, "position": angles, "velocity": [], "effort": []}


def imu(row):
    return {
        "header": header(row["t_s"]), "orientation": turned(row), "orientation_covariance": [0.0] * 9,
        "angular_velocity": vector(0.0, 0.0, row["w_rad_s"]), "angular_velocity_covariance": [0.0] * 9,
        "linear_acceleration": vector(0.0, 0.0, 9.81), "linear_acceleration_covariance": [0.0] * 9,
    }


def odometry(row):
    return {
        "header": header(row["t_s"]), "child_frame_id": "base_link",
        "pose": {"pose": pose(row), "covariance": [0.0] * 36},
        "twist": {"twist": {"linear": vector(0.0), "angular": vector(0.0)}, "covariance": [0.0] * 36},
    }


def rows(path):
    with open(path, newline="") as file:
        drive = [{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(file)]
    angles, before_s = {"wheel_left_rad": 0.0, "wheel_right_rad": 0.0}, drive[0]["t_s"]
    for row, held in zip(drive, drive[:1] + drive):
        for side, name in ((-1, "wheel_left_rad"), (1, "wheel_right_rad")):
            angles[name] += (held["v_m_s"] + side * 0.1 * held["w_rad_s"]) / 0.03 * (row["t_s"] - before_s)
        row.update(angles)
        before_s = row["t_s"]
    return drive


def write(path, compression, kinds, drive):
    bag = Bag(path, compression)
    for row in drive:
        t_s = row["t_s"]
        for topic, kind in kinds:
            name = kind.split("/")[-1]
            message = {
                "Twist": lambda: twist(row),
                "TwistStamped": lambda: {"header": header(t_s), "twist": twist(row)},
                "PoseStamped": lambda: {"header": header(t_s), "pose": pose(row)},
                "Odometry": lambda: odometry(row),
                "TFMessage": lambda: tf(row, "map", "base_link"),
                "Range": lambda: range_of(row),
                "LaserScan": lambda: scan(row),
                "JointState": lambda: joints(row),
                "Imu": lambda: imu(row),
            }[name]()
            bag.write(topic, kind, t_s, message)
    bag.writer.finish()


def main(drive, folder):
    drive, folder = rows(drive), Path(folder)
    command, stamped = ("/cmd_vel", "geometry_msgs/msg/Twist"), ("/cmd_vel", "geometry_msgs/msg/TwistStamped")
    tracked, odom = ("/robot/pose", "geometry_msgs/msg/PoseStamped"), ("/odom", "nav_msgs/msg/Odometry")
    transforms = ("/tf", "tf2_msgs/msg/TFMessage")
    sonar, laser = ("/sonar", "sensor_msgs/msg/Range"), ("/scan", "sensor_msgs/msg/LaserScan")
    write(folder / "tracker.mcap", CompressionType.ZSTD, [command, tracked, sonar], drive)
    wheels, gyro = ("/joint_states", "sensor_msgs/msg/JointState"), ("/imu", "sensor_msgs/msg/Imu")
    write(folder / "odometry.mcap", CompressionType.LZ4, [stamped, odom, laser, wheels, gyro], drive)
    write(folder / "untracked.mcap", CompressionType.ZSTD, [command, sonar, wheels, gyro], drive)
    write(folder / "transforms.mcap", CompressionType.NONE, [command, transforms], drive)
    localised(folder / "localised.mcap", CompressionType.ZSTD, drive)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
