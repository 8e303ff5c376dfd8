"""Finds the gap between a small robot and its simulator, and evolves controllers that cross it.

Lengths are centimetres, angles degrees, times milliseconds, as the names say. The same seed, inputs and version give the
same results on any number of threads. Other threads run while a function works; an interrupt is heard when it has ended.
"""

from collections.abc import Mapping, Sequence
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
    "simulate",
    "train",
]

__version__: Final[str]

_Path: TypeAlias = str | PathLike[str]
_Facts: TypeAlias = dict[str, Any]
_Tables: TypeAlias = _Path | Mapping[str, Any]
_Run: TypeAlias = pd.DataFrame | np.ndarray[Any, Any] | Mapping[str, ArrayLike]

class Error(Exception):
    """Why something could not be done, in one line."""

@final
class Logs:
    """Runs of a robot in a scene."""

    def __new__(cls, runs: pd.DataFrame | Mapping[str, _Run], robot: _Tables, scene: _Tables | None = None) -> Logs:
        """Logs from frames or arrays, with the checks of a folder of logs.

        runs: one frame with a column `run`, or for each run's name a frame, a structured array or a dict of arrays.
            Columns are those of run-*.csv: t_ms, left, right (-100 to 100), x_cm, y_cm, heading_deg, echo_cm. NaN stands
            where the tracker lost the robot or the sensor gave no value.
        robot: path of robot.toml, or a dict of what stands in one.
        scene: the same of scene.toml; open ground without one.
        """

    @staticmethod
    def read(folder: _Path) -> Logs:
        """Reads a folder of logs; what is odd in it is warned of."""

    def write(self, folder: _Path, *, force: bool = False) -> None:
        """Writes a folder of logs; one that is not empty is taken with `force` only, and what others keep there stays."""

    @property
    def runs(self) -> dict[str, dict[str, np.ndarray[Any, Any]]]:
        """The runs: arrays by name of column, by name of run. NaN stands where a cell is empty."""

    def frame(self) -> pd.DataFrame:
        """All runs in one frame, with a column `run`."""

    @property
    def robot(self) -> _Facts:
        """The robot, as in robot.toml."""

    @property
    def scene(self) -> _Facts:
        """The scene, as in scene.toml."""

    def check(self) -> _Facts:
        """What the logs hold, what is wrong with them, what they suffice for, and what to drive more."""

    def __len__(self) -> int: ...

@final
class Simulator:
    """A simulator of a robot: five networks, and how reality scatters about them."""

    @staticmethod
    def read(path: _Path) -> Simulator:
        """Reads a simulator file."""

    def write(self, path: _Path, *, force: bool = False) -> None:
        """Writes a simulator file; what is there and no simulator is replaced with `force` only."""

    @property
    def origin(self) -> _Facts:
        """How it was made."""

    @property
    def robot(self) -> _Facts:
        """Its robot, as in robot.toml."""

    @property
    def added(self) -> list[_Facts]:
        """The effects that were added to it, in the order in which they act."""

@final
class Evaluation:
    """How well a simulator's networks do."""

    @property
    def facts(self) -> _Facts:
        """The facts of `mindgap evaluate --json`."""

    @property
    def networks(self) -> pd.DataFrame:
        """The accuracy of each network."""

    def page(self) -> Page:
        """The page of `mindgap evaluate --html`."""

    def figures(self) -> list[Figure]:
        """The figures of `mindgap evaluate --figures`."""

    def write_figures(self, folder: _Path, *, force: bool = False) -> None:
        """Writes them into a folder as SVG and PNG."""

    def _repr_html_(self) -> str: ...

@final
class Diagnosis:
    """What the gap is, where it lies, what causes it, and how far it shrinks."""

    @property
    def facts(self) -> _Facts:
        """The facts of `mindgap diagnose --json`."""

    @property
    def verdict(self) -> Literal["no_gap", "known", "partly_known", "unknown"]:
        """The answer in one word."""

    @property
    def effects(self) -> pd.DataFrame:
        """The effects that are named, the most probable first; a parameter `p` is the column `parameters.p`."""

    @property
    def budget(self) -> pd.DataFrame:
        """What the gap is made of."""

    @property
    def where(self) -> pd.DataFrame:
        """Where the gap lies."""

    def corrected_simulator(self) -> Simulator:
        """Returns the simulator with the effects that explain the gap, and the formula of the remaining residual."""

    def write_next_experiment(self, path: _Path, *, force: bool = False) -> bool:
        """Writes the commands to log next, as a run in CSV; False where no causes are confused."""

    def page(self) -> Page:
        """The page of `mindgap diagnose --html`."""

    def figures(self) -> list[Figure]:
        """The figures of `mindgap diagnose --figures`."""

    def write_figures(self, folder: _Path, *, force: bool = False) -> None:
        """Writes them into a folder as SVG and PNG."""

    def _repr_html_(self) -> str: ...

@final
class Controller:
    """A six-tuple controller."""

    @staticmethod
    def read(path: _Path) -> Controller:
        """Reads a controller file."""

    def write(self, path: _Path, *, force: bool = False) -> None:
        """Writes a controller file; what is there and was not evolved by mindgap is replaced with `force` only."""

    @property
    def facts(self) -> _Facts:
        """What stands in its file."""

    @property
    def tuples(self) -> pd.DataFrame:
        """Its six tuples."""

@final
class Evolution:
    """A controller that was evolved, and how good it is."""

    @property
    def controller(self) -> Controller:
        """The controller."""

    @property
    def facts(self) -> _Facts:
        """`success` and `crashed` in 200 fresh simulated runs, their `median_cm` from the target, and the `chance` over
        robots that the logs leave possible, None where the simulator knows of none."""

    def figures(self) -> list[Figure]:
        """The figures of `mindgap evolve --figures`."""

    def _repr_html_(self) -> str: ...

@final
class Simulation:
    """Simulated runs of a controller."""

    @property
    def facts(self) -> _Facts:
        """The facts of `mindgap simulate --json`."""

    @property
    def success(self) -> float | None:
        """Share of the runs that reached the target; None in a scene without one."""

    @property
    def runs(self) -> pd.DataFrame:
        """How each run ended."""

    @property
    def paths(self) -> pd.DataFrame:
        """The paths of all runs, step by step."""

    def page(self) -> Page:
        """The page of `mindgap simulate --html`."""

    def figures(self) -> list[Figure]:
        """The figures of `mindgap simulate --figures`."""

    def write_figures(self, folder: _Path, *, force: bool = False) -> None:
        """Writes them into a folder as SVG and PNG."""

    def _repr_html_(self) -> str: ...

@final
class Figure:
    """A figure; a notebook shows it."""

    @property
    def name(self) -> str:
        """The name that its files have."""

    @property
    def svg(self) -> str:
        """The figure as SVG."""

    def png(self) -> bytes:
        """The figure as PNG of 288 dots to the inch."""

    def _repr_svg_(self) -> str: ...

@final
class Page:
    """A page for a browser, whole in one text; a notebook shows it."""

    @property
    def html(self) -> str:
        """Its HTML."""

    def write(self, path: _Path, *, force: bool = False) -> None:
        """Writes it; what is there and no page of mindgap's is replaced with `force` only."""

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

    effects: what is different about it, each as `ID`, `ID=STRENGTH` or `ID=STRENGTH@DETAIL`; `mindgap record --help`
        lists them.
    """

def train(logs: Logs, *, trainer: Literal["fast", "paper"] = "fast", seed: int = 1) -> Simulator:
    """Trains the five networks of a simulator on logs; one that they do not suffice for is warned of."""

def evaluate(simulator: Simulator, logs: Logs) -> Evaluation:
    """Judges a simulator's networks on logs, best on such as it was not trained on."""

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
    controller: whose runs the logs are, where they are: also compares where they end.
    effects: files of effects of your own that compete with the built-in ones.
    step_ms: length of the steps in which rows are compared, unless it is the usual one.
    """

def evolve(
    simulator: Simulator, scene: _Tables, *, start: int = 1, max_steps: int = 60, seed: int = 1
) -> Evolution:
    """Evolves one controller for a start (from 1) of a scene in a simulator.

    scene: path of scene.toml, or a dict of what stands in one, with a target and starts.
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
    """Runs a controller in a simulator: each run is of another robot that its logs leave possible."""
