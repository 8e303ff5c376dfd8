"""Patches the models of `two-worlds` and drives them: `python two_worlds.py MINDGAP TWO_WORLDS`.

Asserts that the unpatched drivers reproduce the simulators' logs, that what was patched closes the gap of `beetle` in path ends
and readings, that other parsers read the patched numbers, and that all other bytes stay. What is patched in `carter`, whose
wheels slip, is printed.
"""

import json
import math
import statistics
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import mujoco

import drive_mjcf
import drive_urdf
from common import read_run, read_toml

STEPS = (10, 25)
# Mean distance of path ends in which a driver repeats its simulator's logs, cm.
REPEATS = {"beetle": 0.5, "carter": 4.0}
WORLDS = {"beetle": ("robot.xml", drive_mjcf.drive), "carter": ("robot.urdf", drive_urdf.drive)}
# What is patched, by world and number of the robot; none: not patched.
EXPECTED = {
    ("beetle", 1): "motor_asymmetry", ("beetle", 2): "track_width", ("beetle", 3): "sonar_yaw", ("beetle", 4): "deadband",
    ("beetle", 5): None, ("carter", 1): "drive_scale", ("carter", 2): "track_width", ("carter", 3): "sonar_offset",
    ("carter", 4): None, ("carter", 5): None,
}
# How much of the gap a patch closes at least.
CLOSED = 0.8


def apart(drive, model, folder, runs):
    """Returns mean distances of path ends (cm), and the median difference of readings (cm)."""
    robot, scene = read_toml(folder / "robot.toml"), read_toml(folder / "scene.toml")
    ends, readings = [], []
    for path in runs:
        run = read_run(path)
        first = run[0]
        start = (first["x_cm"] / 100, first["y_cm"] / 100, math.radians(first["heading_deg"]))
        rows = drive(model, robot, [(row["t_ms"], row["left"], row["right"]) for row in run], scene, start)
        for steps in STEPS:
            for k in range(0, len(run) - steps, steps):
                real = relative(*((row["x_cm"], row["y_cm"], math.radians(row["heading_deg"])) for row in (run[k], run[k + steps])))
                ours = relative(*((100 * row[3], 100 * row[4], row[5]) for row in (rows[k], rows[k + steps])))
                ends.append(math.dist(real, ours))
        readings += [row["echo_cm"] - 100 * own[6] for row, own in zip(run[:10], rows) if row["echo_cm"] is not None and own[6] is not None]
    return statistics.mean(ends), statistics.median(map(abs, readings))


def relative(a, b):
    dx, dy = b[0] - a[0], b[1] - a[1]
    return math.cos(a[2]) * dx + math.sin(a[2]) * dy, -math.sin(a[2]) * dx + math.cos(a[2]) * dy


def read_back(patches, model):
    """Asserts that another parser finds the new values at the paths."""
    tree = ElementTree.parse(model).getroot()
    for patch in patches:
        if patch["new"].startswith("<"):
            # A replaced element has another name than in the path.
            continue
        path, _, attribute = patch["tag"].partition("/@")
        path = path.split("/", 2)[2]
        element = tree.find(path)
        assert element is not None, patch["tag"]
        if attribute:
            assert element.get(attribute) == patch["new"], patch
        else:
            assert element.text.strip() == patch["new"], patch
    if model.suffix == ".xml":
        mujoco.MjModel.from_xml_path(str(model))


def untouched(old, new, patches):
    """Asserts that undoing each replacement gives the old bytes."""
    for patch in reversed(patches):
        if patch["old"]:
            assert patch["new"] in new, patch
    for a, b in zip(old.splitlines(keepends=True), new.splitlines(keepends=True)):
        assert a == b or any(patch["new"] in b for patch in patches), b
    assert len(old.splitlines()) == len(new.splitlines())


def main(mindgap, shared):
    out = Path(tempfile.mkdtemp())
    for world, (name, drive) in WORLDS.items():
        home = Path(shared) / world
        model = home / name
        runs = sorted((home / "simulator").glob("run-*.csv"))[:6]
        repeats, _ = apart(drive, model, home / "simulator", runs)
        print(f"{world}: the driver repeats its simulator's path ends within {repeats:.2f} cm")
        assert repeats < REPEATS[world]
        simulator = out / f"{world}.json"
        subprocess.run([mindgap, "train", home / "simulator", "--out", simulator], check=True, capture_output=True)
        floor = apart(drive, model, home / "robot-05", sorted((home / "robot-05").glob("run-*.csv")))
        for folder in sorted(home.glob("robot-*")):
            number = int(folder.name[-2:])
            patched, report = out / f"{world}-{number}{model.suffix}", out / f"{world}-{number}.json"
            call = [mindgap, "diagnose", simulator, folder, "--patch", f"{model}={patched}", "--json", report]
            subprocess.run(call, check=True, capture_output=True)
            found = json.loads(report.read_text())
            effects = sorted({patch["effect"] for patch in found["patches"]})
            expected = EXPECTED[world, number]
            untouched(model.read_text(), patched.read_text(), found["patches"])
            read_back(found["patches"], patched)
            runs = sorted(folder.glob("run-*.csv"))
            before, after = apart(drive, model, folder, runs), apart(drive, patched, folder, runs)
            index = 0 if expected is None or not expected.startswith("sonar") else 1
            closed = (before[index] - after[index]) / max(before[index] - floor[index], 1e-9)
            print(f"{world} {number}: {effects}; apart {before[index]:.2f} cm, patched {after[index]:.2f}, "
                  f"floor {floor[index]:.2f}, closed {100 * closed:.0f} %; not patched "
                  f"{[(n['effect'], n['reason'][:60]) for n in found['not_patched']]}")
            if world == "beetle":
                assert effects == ([] if expected is None else [expected]), effects
                assert expected is None or closed >= CLOSED, closed


if __name__ == "__main__":
    main(*sys.argv[1:3])
