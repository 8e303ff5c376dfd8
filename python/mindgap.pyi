"""Finds the gap between a small robot and its simulator, and evolves controllers that cross it.

Lengths are in centimetres, angles in degrees and times in milliseconds, as the names say. The same seed, inputs and version
give the same results on any number of threads. Functions release the interpreter, and Ctrl-C interrupts long ones.
"""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, TypeAlias, final

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

__all__ = [
    "Controller",
    "Diagnosis",
    "Error",
    "Evaluation",
    "Evolution",
    "Figure",
    "Logs",
    "Page",
    "Simulation",
    "Simulator",
    "__version__",
    "diagnose",
    "evaluate",
    "evolve",
    "record",
    "rollout",
    "simulate",
    "train",
]

__version__: Final[str]

_Path: TypeAlias = str | PathLike[str]
_Facts: TypeAlias = dict[str, Any]
_Tables: TypeAlias = _Path | Mapping[str, Any]
_Run: TypeAlias = pd.DataFrame | np.ndarray[Any, Any] | Mapping[str, ArrayLike]

class Error(Exception):
    """An operation that failed; the message is one line."""

@final
class Logs:
    """Logged runs of a robot in a scene."""

    def __new__(cls, runs: pd.DataFrame | Mapping[str, _Run], robot: _Tables, scene: _Tables | None = None) -> Logs:
        """Makes logs from frames or arrays, with the checks of a folder of logs.

        runs: one frame with a column `run`, or a mapping from run names to frames, structured arrays or dicts of arrays.
            Columns are those of run-*.csv: t_ms, left, right (-100 to 100), x_cm, y_cm, heading_deg, echo_cm. NaN means
            that the tracker lost the robot or the sensor gave no value.
        robot: path of robot.toml, or a dict with its contents.
        scene: likewise for scene.toml; None for open ground.
        """

    @staticmethod
    def read(folder: _Path) -> Logs:
        """Reads a folder of logs; warns of oddities."""

    def write(self, folder: _Path, *, force: bool = False) -> None:
        """Writes a folder of logs. A folder that is not empty needs `force`; unrelated files in it are kept."""

    @property
    def runs(self) -> dict[str, dict[str, np.ndarray[Any, Any]]]:
        """The runs: arrays by column name, by run name. Empty cells are NaN."""

    def frame(self) -> pd.DataFrame:
        """Returns all runs in one frame, with a column `run`."""

    @property
    def robot(self) -> _Facts:
        """The robot, as in robot.toml."""

    @property
    def scene(self) -> _Facts:
        """The scene, as in scene.toml."""

    def check(self) -> _Facts:
        """Checks the logs: contents, defects, what they can identify, and what to drive next."""

    def __len__(self) -> int: ...

@final
class Simulator:
    """A simulator of a robot: five networks and their noise."""

    @staticmethod
    def read(path: _Path) -> Simulator:
        """Reads a simulator file."""

    def write(self, path: _Path, *, force: bool = False) -> None:
        """Writes a simulator file; replacing anything but a simulator needs `force`."""

    def predict(self, logs: Logs) -> pd.DataFrame:
        """Predicts every row of logs.

        Returns one row per compared value, with the columns `channel` (forward_cm, lateral_cm, turn_deg, echo_probability,
        echo_value_cm), `logged` and `predicted`. For echo_probability, `logged` is 1 if there was an echo and 0 if not.
        """

    @property
    def networks(self) -> dict[str, _Facts | None]:
        """The networks by name, with their weights; None for one that the logs could not train."""

    @property
    def origin(self) -> _Facts:
        """How the simulator was made."""

    @property
    def robot(self) -> _Facts:
        """The robot, as in robot.toml."""

    @property
    def added(self) -> list[_Facts]:
        """The effects added to the simulator, in the order in which they act."""

@final
class Evaluation:
    """The accuracy of a simulator's networks."""

    @property
    def facts(self) -> _Facts:
        """The facts of `mindgap evaluate --json`."""

    @property
    def networks(self) -> pd.DataFrame:
        """The accuracy of each network."""

    def page(self) -> Page:
        """Returns the page of `mindgap evaluate --html`."""

    def figures(self) -> list[Figure]:
        """Returns the figures of `mindgap evaluate --figures`."""

    def write_figures(self, folder: _Path, *, force: bool = False) -> None:
        """Writes the figures into a folder as SVG and PNG."""

    def _repr_html_(self) -> str: ...

@final
class Diagnosis:
    """The size, location and causes of a gap, and how much of it they explain."""

    @property
    def facts(self) -> _Facts:
        """The facts of `mindgap diagnose --json`."""

    @property
    def verdict(self) -> Literal["no_gap", "known", "partly_known", "unknown"]:
        """The verdict."""

    @property
    def effects(self) -> pd.DataFrame:
        """The effects found, most probable first; a parameter `p` is the column `parameters.p`."""

    @property
    def budget(self) -> pd.DataFrame:
        """The contributions to the gap."""

    @property
    def where(self) -> pd.DataFrame:
        """Where the gap lies."""

    def with_effects_applied(self) -> Simulator:
        """Returns the simulator with the effects that explain the gap, and the formula of the remaining residual."""

    def write_next_experiment(self, path: _Path, *, force: bool = False) -> bool:
        """Writes the commands to log next, as a run in CSV. Returns False if no causes are confused."""

    def page(self) -> Page:
        """Returns the page of `mindgap diagnose --html`."""

    def figures(self) -> list[Figure]:
        """Returns the figures of `mindgap diagnose --figures`."""

    def write_figures(self, folder: _Path, *, force: bool = False) -> None:
        """Writes the figures into a folder as SVG and PNG."""

    def _repr_html_(self) -> str: ...

@final
class Controller:
    """A six-tuple controller."""

    @staticmethod
    def read(path: _Path) -> Controller:
        """Reads a controller file."""

    def write(self, path: _Path, *, force: bool = False) -> None:
        """Writes a controller file; replacing anything that mindgap did not evolve needs `force`."""

    @property
    def facts(self) -> _Facts:
        """The contents of its file."""

    @property
    def tuples(self) -> pd.DataFrame:
        """Its six tuples."""

@final
class Evolution:
    """An evolved controller and its success in simulation."""

    @property
    def controller(self) -> Controller:
        """The controller."""

    @property
    def facts(self) -> _Facts:
        """`success` and `crashed` in 200 fresh simulated runs, their `median_cm` from the target, and the `chance` of
        success over the posterior of robots, None if the simulator has no posterior."""

    def figures(self) -> list[Figure]:
        """Returns the figures of `mindgap evolve --figures`."""

    def _repr_html_(self) -> str: ...

@final
class Simulation:
    """Simulated runs of a controller."""

    @property
    def facts(self) -> _Facts:
        """The facts of `mindgap simulate --json`."""

    @property
    def success(self) -> float | None:
        """Share of the runs that reached the target; None if the scene has no target."""

    @property
    def runs(self) -> pd.DataFrame:
        """How each run ended."""

    @property
    def paths(self) -> pd.DataFrame:
        """The paths of all runs, step by step."""

    def page(self) -> Page:
        """Returns the page of `mindgap simulate --html`."""

    def figures(self) -> list[Figure]:
        """Returns the figures of `mindgap simulate --figures`."""

    def write_figures(self, folder: _Path, *, force: bool = False) -> None:
        """Writes the figures into a folder as SVG and PNG."""

    def _repr_html_(self) -> str: ...

@final
class Figure:
    """A figure that a notebook displays."""

    @property
    def name(self) -> str:
        """The name of its files."""

    @property
    def svg(self) -> str:
        """The figure as SVG."""

    def png(self) -> bytes:
        """Returns the figure as PNG with 288 dots per inch."""

    def _repr_svg_(self) -> str: ...

@final
class Page:
    """A self-contained HTML page that a notebook displays."""

    @property
    def html(self) -> str:
        """Its HTML."""

    def write(self, path: _Path, *, force: bool = False) -> None:
        """Writes the page; replacing anything but a page by mindgap needs `force`."""

    def _repr_html_(self) -> str: ...

def record(
    *,
    runs: int = 100,
    steps: int = 60,
    effects: Sequence[str] = ...,
    scene: _Tables | None = None,
    seed: int = 1,
) -> Logs:
    """Records random-command logs of the built-in robot.

    effects: faults to inject, each as `ID`, `ID=STRENGTH` or `ID=STRENGTH@DETAIL`; `mindgap record --help`
        lists them.
    """

def train(logs: Logs, *, trainer: Literal["fast", "paper"] = "fast", seed: int = 1) -> Simulator:
    """Trains the five networks of a simulator on logs; warns of networks that the logs do not support."""

def evaluate(simulator: Simulator, logs: Logs) -> Evaluation:
    """Evaluates a simulator's networks on logs, preferably logs that it was not trained on."""

def diagnose(
    simulator: Simulator | Literal["kinematic"],
    logs: Logs,
    *,
    controller: Controller | None = None,
    effects: Sequence[_Path] = ...,
    step_ms: float | None = None,
    seed: int = 1,
) -> Diagnosis:
    """Finds the gap between a simulator and logs.

    simulator: the simulator, or "kinematic" for the textbook's differential drive and an ideal sonar.
    controller: the controller that drove the logged runs, if any; also compares their end points.
    effects: files with custom effects that compete with the built-in ones.
    step_ms: duration of the steps in which rows are compared; None for the usual one.
    """

def evolve(
    simulator: Simulator, scene: _Tables, *, start: int = 1, max_steps: int = 60, seed: int = 1
) -> Evolution:
    """Evolves one controller for a start (from 1) of a scene in a simulator.

    scene: path of scene.toml, or a dict with its contents, which has a target and starts.
    """

def rollout(
    simulator: Simulator,
    controller: Callable[[_Facts], tuple[float, float]],
    scene: _Tables,
    *,
    start: int = 1,
    steps: int = 100,
    seed: int = 1,
) -> pd.DataFrame:
    """Drives a simulated robot by a controller that is written in Python.

    controller: is called once per step with a dict of t_ms, x_cm, y_cm, heading_deg and echo_cm (None if the sensor gave no
        value), and returns the left and the right command, -100 to 100.
    start: number of the start in the scene, from 1.
    steps: the run ends after this number of steps, or when the robot touches something.

    Returns the run as a frame with the columns of run-*.csv. Its last row is the end, with commands of zero, and
    `frame.attrs["crashed"]` says whether the robot touched something.
    """

def simulate(
    simulator: Simulator,
    controller: Controller,
    scene: _Tables,
    *,
    start: int = 1,
    runs: int = 10,
    seed: int = 1,
) -> Simulation:
    """Runs a controller in a simulator; each run samples a robot from the posterior."""
