"""Runs of evolved controllers in rooms that nobody trained in, of the robot as it is and with something different about it,
and what a diagnosis calls them: writes runs.csv beside this script. `mindgap` has to be on the path. Ten minutes on two
free cores.
"""

import csv
import json
import math
import pathlib
import random
import shutil
import subprocess
import tempfile

ROOMS = 27
EFFECTS = ["", "motor_asymmetry=0.15", "track_width=1.12", "sonar_dropout=0.2", "sonar_offset=6", "latency=150",
           "backlash=40", "brush_advance=0.3", "sticky_patch=0.4", "castor_kick=1.2"]
OBSTACLE = "[[obstacle]]\nx_cm = {}\ny_cm = {}\nwidth_cm = {}\nheight_cm = {}\n"
START = "[[start]]\nx_cm = {}\ny_cm = {}\nheading_deg = {}\n"
# How far obstacles lie apart, targets and starts from them, and starts from the target.
APART_CM, CLEAR_CM, FAR_CM = 45, 25, 80


def room(rng):
    """A scene of two to four obstacles, a target and two starts."""
    width, height = rng.randint(200, 300), rng.randint(180, 260)
    obstacles = []
    for _ in range(rng.randint(2, 4)):
        for _ in range(100):
            w, h = rng.randint(15, 40), rng.randint(15, 40)
            x, y = rng.randint(30, width - 70), rng.randint(30, height - 70)
            if all(x > a + c + APART_CM or a > x + w + APART_CM or y > b + d + APART_CM or b > y + h + APART_CM
                   for a, b, c, d in obstacles):
                obstacles.append((x, y, w, h))
                break

    def free():
        while True:
            x, y = rng.randint(35, width - 35), rng.randint(35, height - 35)
            if all(x < a - CLEAR_CM or x > a + c + CLEAR_CM or y < b - CLEAR_CM or y > b + d + CLEAR_CM
                   for a, b, c, d in obstacles):
                return x, y

    target, starts = free(), []
    while len(starts) < 2:
        place = free()
        if math.dist(place, target) > FAR_CM:
            starts.append((*place, rng.choice([0, 90, 180, 270])))
    return "".join([f"[arena]\nwidth_cm = {width}\nheight_cm = {height}\n", *(OBSTACLE.format(*o) for o in obstacles),
                    "[target]\nx_cm = {}\ny_cm = {}\n".format(*target), *(START.format(*s) for s in starts)])


def diagnosed(here, number):
    """A row for each effect of the room in a folder with a simulator and its logs."""
    def mindgap(*arguments):
        subprocess.run(["mindgap", "--quiet", *map(str, arguments)], cwd=here, check=True)

    scene = f"room-{number}.toml"
    (here / scene).write_text(room(random.Random(900 + number)))
    for start in (1, 2):
        mindgap("evolve", "sim.json", "--scene", scene, "--start", start, "--seed", number, "--out", f"{number}-{start}.toml")
    for effect in EFFECTS:
        logs = here / f"{number}-{effect}"
        logs.mkdir()
        shutil.copy(here / "training" / "robot.toml", logs)
        shutil.copy(here / scene, logs / "scene.toml")
        for start in (1, 2):
            for seed in (1, 2, 3):
                mindgap("drive", f"{number}-{start}.toml", "--scene", scene, "--start", start, "--seed", 100 * number + seed,
                        "--out", logs / f"run-{start}-{seed}.csv", *(["--effect", effect] if effect else []))
        mindgap("diagnose", "sim.json", logs, "--json", f"{logs.name}.json")
        found = json.loads((here / f"{logs.name}.json").read_text())
        first = next(iter(found["effects"]), {})
        yield [number, effect, found["verdict"], first.get("id", ""), first.get("probability", "")]


def main():
    with tempfile.TemporaryDirectory() as folder, open(pathlib.Path(__file__).with_name("runs.csv"), "w") as out:
        here, table = pathlib.Path(folder), csv.writer(out, lineterminator="\n")
        for command in ("record --out training --runs 100 --seed 1", "train training --out sim.json --seed 1"):
            subprocess.run(["mindgap", "--quiet", *command.split()], cwd=here, check=True)
        table.writerow(["room", "effect", "verdict", "first", "probability"])
        for number in range(ROOMS):
            table.writerows(diagnosed(here, number))


main()
