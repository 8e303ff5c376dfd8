"""Tests the wheel as a user does: frames in, and the same results as the command."""

import json
import os
import pickle
import signal
import subprocess
import threading
import time
from pathlib import Path

import nbformat
import numpy as np
import pandas as pd
import pytest
from nbclient import NotebookClient

import mindgap

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
