"""Tests the wheel as a user does: frames in, and the same results as the command."""

import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import nbformat
import numpy as np
import pandas as pd
import pytest
from nbclient import NotebookClient

import mindgap

BAGS = Path(__file__).parents[1] / "src" / "ros_bags.py"
NOTEBOOK = Path(__file__).parents[2] / "python" / "examples" / "gap.ipynb"
SCENE = {
    "arena": {"width_cm": 200, "height_cm": 150},
    "obstacle": [{"x_cm": 90, "y_cm": 70, "width_cm": 20, "height_cm": 20}],
    "target": {"x_cm": 160, "y_cm": 40},
    "start": [{"x_cm": 40, "y_cm": 40, "heading_deg": 0}],
}


@pytest.fixture(scope="module")
def logs():
    return mindgap.record(runs=12, steps=40, seed=1)


@pytest.fixture(scope="module")
def simulator(logs):
    return mindgap.train(logs, seed=1)


@pytest.fixture(scope="module")
def weak():
    return mindgap.record(runs=12, steps=40, effects=["motor_asymmetry=0.15"], seed=2)


@pytest.fixture(scope="module")
def diagnosis(simulator, weak):
    return mindgap.diagnose(simulator, weak)


def command(folder, *arguments):
    """Runs the command and returns its standard output as JSON."""
    done = subprocess.run([os.environ["MINDGAP"], *arguments], cwd=folder, check=True, capture_output=True)
    return json.loads(done.stdout)


def in_one_line(refusal):
    assert "\n" not in str(refusal.value)
    return str(refusal.value)


def test_logs_survive_frames_and_arrays_unchanged(logs):
    frame = logs.frame()
    assert set(frame["run"]) == set(logs.runs) and len(logs) == 12
    assert frame["echo_cm"].isna().any(), "some readings are missing"
    structured = {name: rows.drop(columns="run").to_records(index=False) for name, rows in frame.groupby("run")}
    for given in [frame, logs.runs, structured]:
        again = mindgap.Logs(given, logs.robot, logs.scene)
        pd.testing.assert_frame_equal(again.frame(), frame)
        assert (again.robot, again.scene) == (logs.robot, logs.scene)


def test_arrays_of_any_type_and_stride_are_accepted(logs):
    runs = {name: {column: array[::2].astype("float32") for column, array in run.items()} for name, run in logs.runs.items()}
    robot = logs.robot | {"step_ms": 2 * logs.robot["step_ms"]}
    assert len(mindgap.Logs(runs, robot).frame()) == sum(len(run["t_ms"]) for run in runs.values())


def test_errors_are_one_line_with_their_place(logs, simulator, tmp_path):
    frame = logs.frame()
    frame.loc[3, "left"] = 180.0
    with pytest.raises(mindgap.Error) as refusal:
        mindgap.Logs(frame, logs.robot, logs.scene)
    assert in_one_line(refusal) == "run-000:5: left = 180 lies outside -100..100"
    with pytest.raises(mindgap.Error) as refusal:
        mindgap.Logs(logs.frame().drop(columns="heading_deg"), logs.robot)
    assert "heading_deg is missing" in in_one_line(refusal)
    with pytest.raises(mindgap.Error, match="robot.*wheel_diameter_cm"):
        mindgap.Logs(logs.frame(), {"step_ms": 400}, SCENE)
    with pytest.raises(mindgap.Error, match="nowhere"):
        mindgap.Logs.read(tmp_path / "nowhere")
    with pytest.raises(mindgap.Error, match="start 7"):
        mindgap.evolve(simulator, SCENE, start=7)
    with pytest.raises(TypeError, match="kinematic"):
        mindgap.diagnose("textbook", logs)


def test_unknown_column_gives_a_warning(logs):
    with pytest.warns(UserWarning, match="temperature"):
        mindgap.Logs(logs.frame().assign(temperature=20.0), logs.robot, logs.scene)


def test_diagnosis_equals_that_of_the_command(simulator, weak, diagnosis, tmp_path):
    simulator.write(tmp_path / "sim.json")
    weak.write(tmp_path / "weak")
    read = mindgap.diagnose(mindgap.Simulator.read(tmp_path / "sim.json"), mindgap.Logs.read(tmp_path / "weak"))
    assert read.facts == command(tmp_path, "diagnose", "sim.json", "weak", "--json", "-")
    textbook = mindgap.diagnose("kinematic", mindgap.Logs.read(tmp_path / "weak"), seed=5)
    assert textbook.facts == command(tmp_path, "diagnose", "kinematic", "weak", "--seed", "5", "--json", "-")
    # Files keep two decimals.
    assert diagnosis.verdict == read.verdict == "known"
    assert list(diagnosis.effects["id"]) == ["motor_asymmetry"] and repr(diagnosis).endswith("known: motor_asymmetry>")
    assert 0.8 < diagnosis.effects["parameters.factor"][0] < 0.9
    assert diagnosis.budget["share"].sum() == pytest.approx(1.0)
    assert set(diagnosis.where["channel"]) <= {"forward", "lateral", "turn", "echo_probability", "echo_value"}


def test_evaluation_equals_that_of_the_command(simulator, logs, tmp_path):
    simulator.write(tmp_path / "sim.json")
    logs.write(tmp_path / "logs")
    evaluation = mindgap.evaluate(simulator, mindgap.Logs.read(tmp_path / "logs"))
    assert evaluation.facts == command(tmp_path, "evaluate", "sim.json", "logs", "--json", "-")
    networks = evaluation.networks.set_index("network")
    assert networks.loc["turn", "r2"] > 0.8 and np.isnan(networks.loc["turn", "brier"])


def test_comparison_equals_that_of_the_command(logs, weak, tmp_path):
    logs.write(tmp_path / "mine")
    weak.write(tmp_path / "real")
    compared = mindgap.compare(mindgap.Logs.read(tmp_path / "mine"), mindgap.Logs.read(tmp_path / "real"))
    facts = command(tmp_path, "compare", "mine", "--real", "real", "--json", "-")
    assert compared.facts == {name: fact for name, fact in facts.items() if name not in ["patches", "not_patched"]}
    assert compared.diagnosis.verdict == "known" and list(compared.diagnosis.effects["id"]) == ["motor_asymmetry"]
    again = mindgap.compare(logs, mindgap.Logs(logs.runs, logs.robot, logs.scene))
    assert len(again.pairs) == len(logs) and again.pairs["end_cm"].max() == 0.0
    assert again.simulator.networks["turn"] is not None and "no_gap" in repr(again)
    assert "the same commands" in again.page().html
    with pytest.raises(mindgap.Error, match="has 9 steps, and learning needs 200"):
        mindgap.compare(mindgap.record(runs=1, steps=9), weak)


def test_adaptation_equals_that_of_the_command(simulator, weak, tmp_path):
    simulator.write(tmp_path / "sim.json")
    weak.write(tmp_path / "weak")
    adapted = mindgap.adapt(simulator, mindgap.Logs.read(tmp_path / "weak"))
    facts = command(tmp_path, "adapt", "sim.json", "weak", "--out", "adapted.json", "--json", "-")
    assert [adapted.facts] == facts["lessons"]
    assert adapted.simulator.added == mindgap.Simulator.read(tmp_path / "adapted.json").added
    gap = adapted.facts["gap"]
    assert all(after < before for before, after in gap.values())
    with pytest.raises(mindgap.Error, match="robot"):
        mindgap.adapt(simulator, mindgap.Logs(weak.runs, weak.robot | {"track_cm": 30.0}))


def test_simulator_with_effects_applied_has_no_gap(diagnosis, weak):
    corrected = diagnosis.with_effects_applied()
    assert [effect["effect"] for effect in corrected.added] == ["motor_asymmetry"]
    assert mindgap.diagnose(corrected, weak).verdict == "no_gap"


def test_evolution_and_simulation_equal_those_of_the_command(simulator, tmp_path):
    evolution = mindgap.evolve(simulator, SCENE, max_steps=15, seed=3)
    simulation = mindgap.simulate(simulator, evolution.controller, SCENE, runs=8, seed=4)
    assert len(simulation.runs) == 8 and set(simulation.paths["run"]) == set(range(1, 9))
    assert evolution.facts["success"] > 0.5 and 0.0 <= evolution.facts["chance"]["success"] <= 1.0
    assert len(evolution.controller.tuples) == 6
    simulator.write(tmp_path / "sim.json")
    evolution.controller.write(tmp_path / "controller.toml")
    mindgap.Logs(mindgap.record(runs=1, steps=3).runs, simulator.robot, SCENE).write(tmp_path / "room")
    again = mindgap.Controller.read(tmp_path / "controller.toml")
    assert again.facts["tuple"] == evolution.controller.facts["tuple"]
    facts = command(
        tmp_path, "simulate", "sim.json", "controller.toml", "--scene", "room/scene.toml",
        "--runs", "8", "--seed", "4", "--json", "-",
    )
    assert simulation.success == facts["success"] and len(facts["runs"]) == 8
    assert [run["end_x_cm"] for run in facts["runs"]] == pytest.approx(list(simulation.runs["end_x_cm"]))


def test_controllers_in_python_drive_the_simulated_robot(simulator):
    """Turns before walls, and so lives longer than one that drives straight on."""
    def careful(seen):
        assert set(seen) == {"t_ms", "x_cm", "y_cm", "heading_deg", "echo_cm"}
        is_near = seen["echo_cm"] is not None and seen["echo_cm"] < 45
        return (40, -40) if is_near else (40, 40)

    runs = [mindgap.rollout(simulator, careful, SCENE, steps=20, seed=3) for _ in range(2)]
    pd.testing.assert_frame_equal(*runs)
    assert list(runs[0].columns) == ["t_ms", "left", "right", "x_cm", "y_cm", "heading_deg", "echo_cm"]
    straight = mindgap.rollout(simulator, lambda seen: (80, 80), SCENE, steps=20)
    assert straight.attrs["crashed"] and len(straight) < len(runs[0])
    assert (straight.iloc[0]["x_cm"], straight.iloc[-1]["left"]) == (40, 0)
    again = mindgap.Logs({"run-000": runs[0]}, simulator.robot, SCENE)
    assert len(again.frame()) == len(runs[0])
    for commands, problem in [((180, 0), "step 0: commands 180 and 0"), ((float("nan"), 0), "step 0: commands NaN and 0")]:
        with pytest.raises(mindgap.Error, match=problem):
            mindgap.rollout(simulator, lambda seen: commands, SCENE)
    with pytest.raises(ZeroDivisionError):
        mindgap.rollout(simulator, lambda seen: 1 / 0, SCENE)


def test_a_robot_is_driven_step_by_step(simulator):
    robot = mindgap.SimulatedRobot(simulator, SCENE, seed=3)
    run = mindgap.rollout(simulator, lambda seen: (60, 50), SCENE, steps=5, seed=3)
    seen = [robot.seen] + [robot.drive(60, 50) for _ in range(5)]
    pd.testing.assert_frame_equal(pd.DataFrame(seen), run.drop(columns=["left", "right"]))
    assert not robot.crashed and robot.reached is False
    assert robot.distance_cm == pytest.approx(np.hypot(160 - robot.seen["x_cm"], 40 - robot.seen["y_cm"]))
    with pytest.raises(mindgap.Error, match="step 5: commands 101 and 0"):
        robot.drive(101, 0)
    with pytest.raises(mindgap.Error, match="start 2"):
        mindgap.SimulatedRobot(simulator, SCENE, start=2)
    untargeted = {name: table for name, table in SCENE.items() if name != "target"}
    assert mindgap.SimulatedRobot(simulator, untargeted).reached is None


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """A drive of the built-in robot as a table with the columns of many stacks, as bags, and its robot."""
    folder = tmp_path_factory.mktemp("drive")
    logs = mindgap.record(runs=1, steps=150, seed=9)
    robot, run = logs.robot, logs.frame().dropna(subset=["x_cm"])
    left, right = (run[side] / 100 * robot["full_speed_cm_s"] / 100 for side in ["left", "right"])
    half_rad = np.radians(run["heading_deg"]) / 2
    columns = {"t_s": run["t_ms"] / 1000, "v_m_s": (left + right) / 2, "w_rad_s": (right - left) / robot["track_cm"] * 100}
    columns |= {"x_m": run["x_cm"] / 100, "y_m": run["y_cm"] / 100, "qz": np.sin(half_rad), "qw": np.cos(half_rad)}
    pd.DataFrame(columns | {"range_m": run["echo_cm"].fillna(np.inf) / 100}).to_csv(folder / "drive.csv", index=False)
    subprocess.run([sys.executable, BAGS, folder / "drive.csv", folder], check=True)
    logs.write(folder / "logs")
    return folder


@pytest.mark.parametrize(
    ("arguments", "imported"),
    [
        (["bag", "tracker.mcap"], lambda robot: mindgap.import_bags("tracker.mcap", robot=robot)),
        (["bag", "tracker.mcap", "--ranges", "none", "--watchdog-ms", "500"],
         lambda robot: mindgap.import_bags(["tracker.mcap"], robot=robot, ranges="none", watchdog_ms=500)),
        (["streams", "drive.csv", "--offset-ms", "20"],
         lambda robot: mindgap.import_streams(Path("drive.csv"), robot=robot, offset_ms=20.0)),
    ],
)
def test_imports_equal_those_of_the_command(drive, tmp_path, monkeypatch, arguments, imported):
    monkeypatch.chdir(drive)
    made = imported("logs/robot.toml")
    by_command = tmp_path / "by-command"
    facts = command(drive, "import", *arguments, "--robot", "logs/robot.toml", "--out", by_command, "--json", "-")
    assert made.facts == facts
    made.write(tmp_path / "by-python")
    for file in by_command.iterdir():
        assert (tmp_path / "by-python" / file.name).read_text() == file.read_text(), file.name
    assert len(made.logs) == 1 and made.logs.frame()["x_cm"].notna().all()
    assert str(made).startswith(facts["recordings"][0]["sources"][0]["name"])


def test_imports_draft_the_robot_and_take_dicts(drive):
    drafted = mindgap.import_streams(drive / "drive.csv")
    assert any("wheel_diameter_cm" in line for line in drafted.facts["to_fill_in"])
    robot = mindgap.Logs.read(drive / "logs").robot
    columns = {"time": "t_s", "forward": "v_m_s", "turn": "w_rad_s", "x": "x_m", "y": "y_m", "qz": "qz", "qw": "qw"}
    mapped = mindgap.import_streams(drive / "drive.csv", robot=robot, scene=SCENE, map={"drive.csv": columns})
    assert mapped.logs.robot == robot and mapped.logs.scene["target"] == SCENE["target"]
    assert "echo_cm" not in mapped.logs.frame(), "the map does not name the readings"


def test_brick_logs_equal_those_of_the_command(drive, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = pd.read_csv(drive / "logs" / "run-000.csv").dropna(subset=["x_cm"])
    run.drop(columns=["x_cm", "y_cm", "heading_deg"]).to_csv("brick.csv", index=False)
    frames_ms = np.arange(0, run["t_ms"].max(), 50)
    poses = [run["x_cm"], run["y_cm"], np.unwrap(np.radians(run["heading_deg"]))]
    x_cm, y_cm, heading_rad = (np.interp(frames_ms, run["t_ms"], values) for values in poses)
    track = {"time_s": frames_ms / 1000 + 50, "x_m": x_cm / 100, "y_m": y_cm / 100, "yaw_rad": heading_rad}
    pd.DataFrame(track).to_csv("track.csv", index=False)
    given = [drive / "logs" / "robot.toml", drive / "logs" / "scene.toml"]
    made = mindgap.import_brick(["brick.csv", "track.csv"], *given)
    facts = command(
        tmp_path, "import", "brick.csv", "track.csv", "--robot", given[0], "--scene", given[1], "--out", "out", "--json", "-",
    )
    assert made.facts == facts and facts["logs"][0]["run"]["offset_ms"] == pytest.approx(50_000, abs=200)
    made.write("by-python")
    assert Path("by-python/run-000.csv").read_text() == Path("out/run-000.csv").read_text()


def test_imports_that_fail_say_why_in_one_line(drive, tmp_path):
    for refused, problem in [
        (lambda: mindgap.import_bags(tmp_path / "nowhere.mcap"), "nowhere.mcap"),
        (lambda: mindgap.import_bags(drive / "drive.csv"), "drive.csv"),
        (lambda: mindgap.import_bags(drive / "tracker.mcap", commands="/nothing"), "/nothing"),
        (lambda: mindgap.import_bags(drive / "tracker.mcap", watchdog_ms=-1), "watchdog_ms: give a time in ms, or none"),
        (lambda: mindgap.import_streams(drive / "drive.csv", time_unit="h"), "time_unit: \"h\" is not a unit of time"),
        (lambda: mindgap.import_streams([]), "0 file"),
        (lambda: mindgap.import_streams(drive / "drive.csv", map={"drive.csv": {"colour": "x_m"}}), "colour"),
    ]:
        with pytest.raises(mindgap.Error) as refusal:
            refused()
        assert problem in in_one_line(refusal)


def test_exports_equal_those_of_the_command(simulator, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mindgap.evolve(simulator, SCENE, max_steps=5).controller.write("controller.toml")
    simulator.write("sim.json")
    controller = mindgap.Controller.read("controller.toml")
    for what, file, format, options, arguments in [
        (controller, "controller.nxc", "nxc", {}, []),
        (controller, "a.nxc", "nxc", {"name": "a", "left": "A", "log": "b.csv", "display": True, "stop_cm": 9, "stall": True},
         ["--left", "A", "--log", "b.csv", "--display", "--stop-cm", "9", "--stall"]),
        (controller, "controller.rxe", "rxe", {"sonar": "1"}, ["--sonar", "1"]),
        (controller, "controller.rs", "rust", {}, []),
        (controller, "controller.h", "c", {}, []),
        (controller, "controller.ino", "arduino", {}, []),
        (controller, "controller.py", "pybricks", {}, []),
        (simulator, "networks.h", "c", {"monitor": True}, ["--monitor"]),
        (simulator, "networks.py", "pybricks", {}, []),
    ]:
        given = "sim.json" if what is simulator else "controller.toml"
        command(tmp_path, "export", given, "--format", format, "--out", file, *arguments, "--json", "-")
        exported = mindgap.export(what, format, **options)
        assert exported == (Path(file).read_bytes() if format == "rxe" else Path(file).read_text()), file


def test_exports_that_a_board_cannot_run_are_refused(simulator):
    controller = mindgap.evolve(simulator, SCENE, max_steps=5).controller
    for what, format, options, problem in [
        (controller, "basic", {}, '"basic" is not a format of programs'),
        (controller, "c", {"log": True}, "a log and a display need a controller and format nxc"),
        (controller, "c", {"stop_cm": 10}, "a stop distance and a stall check need a program for a brick"),
        (controller, "nxc", {"stop_cm": 300}, "stop_cm = 300 lies outside 1..254"),
        (controller, "nxc", {"left": "D"}, "\"D\" is not a motor port"),
        (controller, "nxc", {"left": "C"}, "left and right motor cannot both be on port C"),
        (controller, "rxe", {"name": "a name with blanks"}, "cannot be a file name on the brick"),
        (controller, "c", {"monitor": True}, "a monitor needs a simulator"),
        (simulator, "rxe", {}, "contains networks"),
    ]:
        with pytest.raises(mindgap.Error) as refusal:
            mindgap.export(what, format, **options)
        assert problem in in_one_line(refusal)
    with pytest.raises(TypeError):
        mindgap.export("controller.toml", "nxc")


def test_predictions_and_weights_are_data(simulator, logs):
    predictions = simulator.predict(logs).set_index("channel")
    forward = predictions.loc["forward_cm"]
    assert np.corrcoef(forward["logged"], forward["predicted"])[0, 1] > 0.9
    assert predictions.loc["echo_probability", "predicted"].between(0, 1).all()
    assert set(simulator.networks) == {"turn", "forward", "lateral", "echo_probability", "echo_value"}
    weights = np.array([unit["weights"] for unit in simulator.networks["echo_value"]["summation"]])
    assert weights.ndim == 2 and weights.shape[1] == 2


def test_simulators_and_logs_are_pickled(simulator, logs):
    again = pickle.loads(pickle.dumps({"simulator": simulator, "logs": logs}))
    assert again["simulator"].networks == simulator.networks and again["simulator"].origin == simulator.origin
    pd.testing.assert_frame_equal(again["logs"].frame(), logs.frame())


def test_a_printed_diagnosis_is_its_summary(diagnosis):
    assert str(diagnosis).startswith("There is a gap") and "motor_asymmetry" in str(diagnosis)


def test_figures_and_pages_are_displayed_and_written(diagnosis, simulator, logs, tmp_path):
    for found in [diagnosis, mindgap.evaluate(simulator, logs)]:
        for figure in found.figures():
            assert figure._repr_svg_() == figure.svg and figure.svg.startswith("<svg")
            assert figure.png().startswith(b"\x89PNG")
        assert found._repr_html_().count("<div>") == len(found.figures())
        found.write_figures(tmp_path / type(found).__name__)
    assert (tmp_path / "Diagnosis" / "budget.png").exists()
    page = diagnosis.page()
    assert page._repr_html_().startswith("<iframe") and '"' not in page._repr_html_().split('srcdoc="')[1].split('"')[0]
    page.write(tmp_path / "gap.html")
    assert (tmp_path / "gap.html").read_text() == page.html


def test_files_of_others_are_replaced_only_with_force(simulator, tmp_path):
    mine = tmp_path / "sim.json"
    mine.write_text("mine")
    with pytest.raises(mindgap.Error, match="sim.json"):
        simulator.write(mine)
    assert mine.read_text() == "mine"
    simulator.write(mine, force=True)
    assert mindgap.Simulator.read(mine).origin == simulator.origin


def test_other_threads_run_during_long_work(logs):
    ended, ticks = threading.Event(), []
    def tick():
        while not ended.is_set():
            ticks.append(None)
            time.sleep(0.001)
    clock = threading.Thread(target=tick)
    clock.start()
    before = len(ticks)
    mindgap.train(logs)
    meanwhile = len(ticks) - before
    ended.set()
    clock.join()
    assert meanwhile > 10


def test_ctrl_c_interrupts_long_work(simulator):
    """The handler runs in the main thread, which is the one that calls the work."""
    # Shells start background jobs with SIGINT ignored, and Python keeps it ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    begun = threading.Event()

    def press():
        begun.wait()
        signal.raise_signal(signal.SIGINT)

    presser = threading.Thread(target=press)
    presser.start()
    with pytest.raises(KeyboardInterrupt):
        begun.set()
        mindgap.evolve(simulator, SCENE, max_steps=200, seed=1)
    presser.join()
    assert mindgap.evolve(simulator, SCENE, max_steps=5, seed=1).facts["start"] == 1, "and nothing is broken"


def test_notebook_runs_from_top_to_bottom(tmp_path):
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output.get("data", {}) for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert any("srcdoc" in "".join(data.get("text/html", "")) for data in shown), "a page is shown"
    assert any("image/svg+xml" in data for data in shown), "a figure is shown"
