"""Drives a two-wheeled robot in PyBullet: obeys Gazebo's tags of the diff-drive plug-in and of the ray sensor as Gazebo does."""

import math
import random
import xml.etree.ElementTree as ElementTree

import pybullet

from common import cast, main, segments_m

STEP_S = 0.005
REST_ROWS = 3
# Of links without mu1: a smooth caster.
PLAIN_FRICTION = 0.17


def drive(model_path, robot, commands, scene=None, start=(0.0, 0.0, 0.0), seed=0):
    """Returns rows of t_ms, left, right, x, y, heading, reading: one per command, at its time."""
    root = ElementTree.parse(model_path).getroot()
    plugin = root.find("gazebo/plugin")
    number = lambda name: float(plugin.findtext(name))
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setGravity(0, 0, -9.81)
        pybullet.setPhysicsEngineParameter(fixedTimeStep=STEP_S, numSolverIterations=60)
        floor = pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE))
        pybullet.changeDynamics(floor, -1, lateralFriction=1.0, rollingFriction=0, spinningFriction=0)
        radius = float(root.find("link/collision/geometry/cylinder").get("radius"))
        body = pybullet.loadURDF(
            str(model_path), [*start[:2], radius], [0, 0, math.sin(start[2] / 2), math.cos(start[2] / 2)],
            flags=pybullet.URDF_USE_INERTIA_FROM_FILE,
        )
        joints = {pybullet.getJointInfo(body, j)[1].decode(): j for j in range(pybullet.getNumJoints(body))}
        links = {pybullet.getJointInfo(body, j)[12].decode(): j for j in range(pybullet.getNumJoints(body))}
        friction = {gazebo.get("reference"): gazebo.findtext("mu1") for gazebo in root.findall("gazebo")}
        for name, link in [(pybullet.getBodyInfo(body)[0].decode(), -1), *links.items()]:
            mu = friction.get(name)
            pybullet.changeDynamics(
                body, link, rollingFriction=0, spinningFriction=0, linearDamping=0, angularDamping=0,
                lateralFriction=float(mu or PLAIN_FRICTION),
            )
        wheels = [joints[plugin.findtext("left_joint")], joints[plugin.findtext("right_joint")]]
        sensor = Sensor(root, links, segments_m(scene or {}), random.Random(seed))
        full, track = robot["full_speed_cm_s"] / 100, robot["track_cm"] / 100
        separation, wheel_radius = number("wheel_separation"), number("wheel_diameter") / 2
        most, torque = number("max_wheel_acceleration") * STEP_S, number("max_wheel_torque")
        speeds = [0.0, 0.0]

        def step(left, right):
            forward, turn = (left + right) / 200 * full, (right - left) / 100 * full / track
            for i, wanted in enumerate([forward - turn * separation / 2, forward + turn * separation / 2]):
                speeds[i] += max(-most, min(most, wanted - speeds[i]))
                pybullet.setJointMotorControl2(
                    body, wheels[i], pybullet.VELOCITY_CONTROL, targetVelocity=speeds[i] / wheel_radius, force=torque
                )
            pybullet.stepSimulation()

        for _ in range(round(REST_ROWS * robot["step_ms"] / 1000 / STEP_S)):
            step(0, 0)
        rows = []
        for (t_ms, left, right), after in zip(commands, commands[1:] + [None]):
            rows.append((t_ms, left, right, *pose(body, root), sensor.reading(body)))
            if after is not None:
                for _ in range(round((after[0] - t_ms) / 1000 / STEP_S)):
                    step(left, right)
        return rows
    finally:
        pybullet.disconnect(client)


def pose(body, root):
    """Returns the pose of the base's frame; PyBullet reports that of its inertia."""
    place, turn = pybullet.getBasePositionAndOrientation(body)
    info = pybullet.getDynamicsInfo(body, -1)
    back = pybullet.invertTransform(info[3], info[4])
    place, turn = pybullet.multiplyTransforms(place, turn, *back)
    return place[0], place[1], pybullet.getEulerFromQuaternion(turn)[2]


class Sensor:
    def __init__(self, root, links, segments, draws):
        gazebo = next(g for g in root.findall("gazebo") if g.find("sensor") is not None)
        ray = gazebo.find("sensor/ray")
        value = lambda path: float(ray.findtext(path))
        count = int(value("scan/horizontal/samples"))
        low, high = value("scan/horizontal/min_angle"), value("scan/horizontal/max_angle")
        self.angles = [low + (high - low) * i / max(count - 1, 1) for i in range(count)]
        self.range = value("range/min"), value("range/max")
        self.mean, self.stddev = value("noise/mean"), value("noise/stddev")
        self.link, self.segments, self.draws = links[gazebo.get("reference")], segments, draws

    def reading(self, body):
        state = pybullet.getLinkState(body, self.link, computeForwardKinematics=True)
        (x, y, _), heading = state[4], pybullet.getEulerFromQuaternion(state[5])[2]
        nearest = min(cast(self.segments, x, y, heading + angle) for angle in self.angles)
        if not math.isfinite(nearest):
            return None
        nearest += self.draws.gauss(self.mean, self.stddev)
        return nearest if self.range[0] <= nearest < self.range[1] else None


if __name__ == "__main__":
    main(drive)
