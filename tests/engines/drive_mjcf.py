"""Drives a two-wheeled robot in MuJoCo: commands are percent of full speed per wheel, for velocity actuators."""

import math
import random

import mujoco

from common import main, rectangles_m

REST_STEPS = 150


def drive(model_path, robot, commands, scene=None, start=(0.0, 0.0, 0.0), seed=0, base="base"):
    """Returns rows of t_ms, left, right, x, y, heading, reading: one per command, at its time."""
    spec = mujoco.MjSpec.from_file(str(model_path))
    for x, y, w, h in walls(scene or {}):
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX, pos=[x + w / 2, y + h / 2, 0.25], size=[w / 2, h / 2, 0.25], contype=0, conaffinity=0
        )
    model = spec.compile()
    data = mujoco.MjData(model)
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, base)
    data.qpos[:2] = start[:2]
    data.qpos[3:7] = [math.cos(start[2] / 2), 0, 0, math.sin(start[2] / 2)]
    for _ in range(REST_STEPS):
        mujoco.mj_step(model, data)
    draws = random.Random(seed)
    full_rad_s = robot["full_speed_cm_s"] / (robot["wheel_diameter_cm"] / 2)
    rows = []
    for (t_ms, left, right), after in zip(commands, commands[1:] + [None]):
        mujoco.mj_forward(model, data)
        x, y, _ = data.xpos[body]
        heading = math.atan2(data.xmat[body][3], data.xmat[body][0])
        rows.append((t_ms, left, right, x, y, heading, reading(model, data, draws)))
        if after is not None:
            data.ctrl[:2] = [left / 100 * full_rad_s, right / 100 * full_rad_s]
            for _ in range(round((after[0] - t_ms) / 1000 / model.opt.timestep)):
                mujoco.mj_step(model, data)
    return rows


def reading(model, data, draws):
    if model.nsensor == 0:
        return None
    distance, cutoff = data.sensordata[0], model.sensor_cutoff[0]
    if distance < 0 or distance >= cutoff:
        return None
    distance += draws.gauss(0, model.sensor_noise[0])
    return distance if 0 < distance < cutoff else None


def walls(scene):
    thick = 0.1
    boxes = rectangles_m(scene)
    if "arena" in scene:
        w, h = scene["arena"]["width_cm"] / 100, scene["arena"]["height_cm"] / 100
        boxes += [(-thick, -thick, thick, h + 2 * thick), (w, -thick, thick, h + 2 * thick)]
        boxes += [(0, -thick, w, thick), (0, h, w, thick)]
    return boxes


if __name__ == "__main__":
    main(drive)
