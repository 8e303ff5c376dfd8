"""Prints the messages of a ROS 2 bag as JSON, with the official reader: for each topic, times in seconds with numbers or texts."""

import json
import sys
from collections import defaultdict

from mcap_ros2.reader import read_ros2_messages


def fields(value):
    """The numbers and texts of a message, in their order, without headers."""
    if isinstance(value, (list, tuple)):
        return [field for part in value for field in fields(part)]
    if hasattr(value, "__slots__"):
        return [field for name in value.__slots__ if name != "header" for field in fields(getattr(value, name))]
    return [value]


messages = defaultdict(list)
for message in read_ros2_messages(sys.argv[1]):
    messages[message.channel.topic].append([message.log_time_ns / 1e9, *fields(message.ros_msg)])
json.dump(messages, sys.stdout)
