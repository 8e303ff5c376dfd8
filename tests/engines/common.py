"""What both drivers share: commands, robot.toml, scenes, and run logs."""

import csv
import math
import tomllib
from pathlib import Path


def read_toml(path):
    return tomllib.loads(Path(path).read_text())


def read_run(path):
    """Returns the rows of a run log or of a file of commands; empty cells are None."""
    with open(path, newline="") as file:
        return [{k: float(v) if v else None for k, v in row.items()} for row in csv.DictReader(file)]


def write_run(path, rows):
    """Writes rows of t_ms, left, right, x_m, y_m, heading_rad, reading_m."""
    with open(path, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["t_ms", "left", "right", "x_cm", "y_cm", "heading_deg", "echo_cm"])
        for t_ms, left, right, x, y, heading, reading in rows:
            echo = "" if reading is None else f"{100 * reading:.3f}"
            table.writerow([f"{t_ms:g}", left, right, f"{100 * x:.4f}", f"{100 * y:.4f}", f"{math.degrees(heading):.4f}", echo])


def rectangles_m(scene):
    """Returns obstacles as (x, y, width, height), m."""
    keys = ("x_cm", "y_cm", "width_cm", "height_cm")
    return [tuple(obstacle[key] / 100 for key in keys) for obstacle in scene.get("obstacle", [])]


def segments_m(scene):
    """Returns walls and the edges of obstacles as (x0, y0, x1, y1), m."""
    rectangles = rectangles_m(scene)
    if "arena" in scene:
        rectangles = rectangles + [(0, 0, scene["arena"]["width_cm"] / 100, scene["arena"]["height_cm"] / 100)]
    segments = [tuple(wall[key] / 100 for key in ("x0_cm", "y0_cm", "x1_cm", "y1_cm")) for wall in scene.get("wall", [])]
    for x, y, w, h in rectangles:
        corners = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
        segments += [(*a, *b) for a, b in zip(corners, corners[1:] + corners[:1])]
    return segments


def cast(segments, x, y, angle):
    """Returns the distance to the first segment, or infinity."""
    dx, dy = math.cos(angle), math.sin(angle)
    nearest = math.inf
    for x0, y0, x1, y1 in segments:
        ex, ey = x1 - x0, y1 - y0
        cross = dx * ey - dy * ex
        if abs(cross) < 1e-12:
            continue
        along = ((x0 - x) * ey - (y0 - y) * ex) / cross
        across = ((x0 - x) * dy - (y0 - y) * dx) / cross
        if along > 0 and 0 <= across <= 1:
            nearest = min(nearest, along)
    return nearest


def main(drive):
    """`python DRIVER.py ROBOT.toml MODEL COMMANDS.csv OUT`: drives from rest on open ground and writes a run log."""
    import sys

    robot, model, commands, out = sys.argv[1:]
    rows = [(row["t_ms"], row["left"], row["right"]) for row in read_run(commands)]
    write_run(out, drive(model, read_toml(robot), rows))
