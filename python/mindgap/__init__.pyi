"""Finds the gap between a small robot and its simulator, and evolves controllers that cross it.

Lengths are in centimetres, angles in degrees and times in milliseconds, as the names say. The same seed, inputs and version
give the same results on any number of threads. Functions release the interpreter, and Ctrl-C interrupts long ones. What cannot
be done raises `Error`, whose message is one line.
"""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, TypeAlias, final, overload

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

__all__ = [
    "Adaptation",
    "Comparison",
    "Controller",
    "Diagnosis",
    "Error",
    "Evaluation",
    "Evolution",
    "Figure",
    "Imported",
    "Logs",
    "Page",
    "SimulatedRobot",
    "Simulation",
    "Simulator",
    "__version__",
    "adapt",
    "compare",
    "diagnose",
    "evaluate",
    "evolve",
    "export",
    "import_bags",
    "import_brick",
    "import_streams",
    "record",
    "rollout",
    "simulate",
    "train",
]

__version__: Final[str]

_Path: TypeAlias = str | PathLike[str]
_Facts: TypeAlias = dict[str, Any]
_Tables: TypeAlias = _Path | Mapping[str, Any]
_Paths: TypeAlias = _Path | Sequence[_Path]
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
class Imported:
    """Logs that were made of recordings, and what was guessed, changed or left out."""

    @property
    def logs(self) -> Logs:
        """The logs."""

    @property
    def facts(self) -> _Facts:
        """The facts of `mindgap import --json`."""

    def write(self, folder: _Path, *, force: bool = False) -> None:
        """Writes the folder of `mindgap import`, in which the draft of a robot marks what to fill in. A folder that is not
        empty needs `force`; unrelated files in it are kept."""

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
class Comparison:
    """What differs between a simulator and the robot, from logs of both."""

    @property
    def diagnosis(self) -> Diagnosis:
        """The diagnosis of the learned simulator on the robot's logs."""

    @property
    def simulator(self) -> Simulator:
        """The simulator that was learned from its logs."""

    @property
    def pairs(self) -> pd.DataFrame:
        """Runs of both sides with the same commands, and how far their paths and ends are from each other."""

    @property
    def facts(self) -> _Facts:
        """The facts of `mindgap compare --json`, without patches."""

    def page(self) -> Page:
        """Returns the page of `mindgap compare --html`."""

@final
class Adaptation:
    """A simulator that was adapted to runs of the robot, and what it learned."""

    @property
    def simulator(self) -> Simulator:
        """The adapted simulator."""

    @property
    def facts(self) -> _Facts:
        """What was learned: a lesson of `mindgap adapt --json`."""

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
class SimulatedRobot:
    """A simulated robot in a scene, driven step by step."""

    def __new__(cls, simulator: Simulator, scene: _Tables, *, start: int = 1, seed: int = 1) -> SimulatedRobot:
        """Places a robot at rest at a start of a scene.

        scene: path of scene.toml, or a dict with its contents, which has starts.
        start: number of the start in the scene, from 1.
        seed: the same seed and commands give the same run.

        Raises Error if there is no such start, or if the simulator lacks a network.
        """

    @property
    def seen(self) -> _Facts:
        """What the robot sees at the beginning of the next step: t_ms, x_cm, y_cm, heading_deg (-180 to 180), and echo_cm,
        None if the sensor gave no value."""

    def drive(self, left: float, right: float) -> _Facts:
        """Drives for one step of the robot, `robot["step_ms"]` of its simulator, and returns what it sees then.

        left, right: commands, -100 to 100.

        A robot that touches something stays there. Raises Error if a command lies outside its range.
        """

    @property
    def scene(self) -> _Facts:
        """The scene, as in scene.toml."""

    @property
    def crashed(self) -> bool:
        """Whether the robot has touched something."""

    @property
    def distance_cm(self) -> float | None:
        """Distance to the target; None if the scene has no target."""

    @property
    def reached(self) -> bool | None:
        """Whether the robot is within 15 cm of the target and has touched nothing; None if the scene has no target."""

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

def import_bags(
    bags: _Paths,
    *,
    robot: _Tables | None = None,
    scene: _Tables | None = None,
    commands: str | None = None,
    poses: str | None = None,
    ranges: str | Mapping[str, str] | None = None,
    gyro: str | None = None,
    left_joints: Sequence[str] = ...,
    right_joints: Sequence[str] = ...,
    watchdog_ms: float | Literal["none"] | None = None,
) -> Imported:
    """Imports bags of ROS 2 (folders, MCAP, SQLite) or ROS 1, as `mindgap import bag`.

    bags: one bag per recording. A bag that cannot be used is left out, with its reason in `facts["left_out"]`.
    robot: path of robot.toml, or a dict with its contents; None to draft it from the recordings.
    scene: likewise for scene.toml; None for open ground.
    commands, poses, gyro: topics; None to guess. A transform is written as in "/tf:map>base_link". "none" for no gyro.
    ranges: topic of the readings, or with several range sensors a mapping from their names to topics; None to guess, "none" for
        no readings.
    left_joints, right_joints: joints of wheels, whose angles are rotation counters; by default guessed from their names.
    watchdog_ms: time after the last command at which the base stops by itself; "none" if it drives on; None to infer it.

    Raises Error if no bag can be used.
    """

def import_streams(
    files: _Paths,
    *,
    robot: _Tables | None = None,
    scene: _Tables | None = None,
    map: _Tables | None = None,
    time_unit: Literal["s", "ms", "us"] | None = None,
    length_unit: Literal["m", "cm", "mm"] | None = None,
    angle_unit: Literal["deg", "rad"] | None = None,
    body: str | None = None,
    offset_ms: float | None = None,
    watchdog_ms: float | Literal["none"] | None = None,
) -> Imported:
    """Imports commands, poses and readings as CSV, as `mindgap import streams`.

    files: a file with both commands and poses is one recording. Otherwise the first file with commands, the first with poses
        and the first with readings form one recording, and so on.
    robot, scene, watchdog_ms: as for `import_bags`.
    map: path of map.toml, or a dict with its contents: quantity and unit of each column, by file name.
    time_unit, length_unit, angle_unit: units of columns whose names give none.
    body: name of the robot's body in a motion capture; None for the one that moves as commanded.
    offset_ms: offset of the pose clock relative to the command clock; None to estimate it from the motion.

    Raises Error if no file can be used, or if the numbers of files of each kind differ.
    """

def import_brick(
    files: _Paths,
    robot: _Tables,
    scene: _Tables,
    *,
    time_unit: Literal["s", "ms", "us"] | None = None,
    length_unit: Literal["m", "cm", "mm"] | None = None,
    angle_unit: Literal["deg", "rad"] | None = None,
    body: str | None = None,
) -> Imported:
    """Merges logs of a brick with tracks of a camera, as `mindgap import`.

    files: brick logs and camera tracks in any order.
    robot: path of robot.toml, or a dict with its contents.
    scene: likewise for scene.toml.
    time_unit, length_unit, angle_unit: units of the track's columns whose names give none.
    body: name of the robot's body in a motion capture; None for the one that moves as the wheels do.

    Raises Error if there is no log or no track, or if no log matches a track.
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

def compare(simulated: Logs, real: Logs, *, seed: int = 1) -> Comparison:
    """Compares your own simulator with the robot, from logs of both, as `mindgap compare`.

    simulated: logs of the simulator, from which its networks are learned. At least 200 steps, with commands like the robot's.
    real: logs of the robot.

    Raises Error if the simulator's logs are not enough.
    """

def adapt(simulator: Simulator, logs: Logs, *, seed: int = 1) -> Adaptation:
    """Adapts a simulator to logs of its robot, as `mindgap adapt`.

    Effects that a diagnosis names are added to the simulator, and what remains is learned as a correction per command.

    Raises Error if the simulator has no parameter uncertainty, or if the logs are of another robot or show no motion.
    """

def evolve(
    simulator: Simulator, scene: _Tables, *, start: int = 1, max_steps: int = 60, seed: int = 1
) -> Evolution:
    """Evolves one controller for a start (from 1) of a scene in a simulator.

    scene: path of scene.toml, or a dict with its contents, which has a target and starts.
    """

@overload
def export(
    what: Controller,
    format: Literal["rxe"],
    *,
    name: str = "controller",
    left: Literal["A", "B", "C"] = "B",
    right: Literal["A", "B", "C"] = "C",
    sonar: Literal["1", "2", "3", "4"] = "4",
    stop_cm: int | None = None,
    stall: bool = False,
) -> bytes: ...
@overload
def export(
    what: Controller | Simulator,
    format: Literal["nxc", "rust", "c", "arduino", "pybricks"],
    *,
    name: str = "controller",
    left: Literal["A", "B", "C"] = "B",
    right: Literal["A", "B", "C"] = "C",
    sonar: Literal["1", "2", "3", "4"] = "4",
    log: bool | str = False,
    display: bool = False,
    stop_cm: int | None = None,
    stall: bool = False,
    monitor: bool = False,
) -> str:
    """Exports a controller as an onboard program, or a simulator's networks as constants for a board, as `mindgap export`.

    format: "nxc" (NXC source), "rxe" (executable of an NXT; bytes), "rust", "c", "arduino" or "pybricks".
    name: name of the program on an NXT, without ending.
    left, right, sonar: ports of motors and sensor on an NXT.
    log: whether an NXT logs every step, or the name of the logs, such as "run.csv"; only with "nxc".
    display: whether an NXT displays tuple, reading and outcome; only with "nxc".
    stop_cm: the robot stops when a reading is below this distance, 1 to 254; only on an NXT.
    stall: whether the robot stops when a driven wheel does not turn; only on an NXT.
    monitor: whether a simulator's monitor is exported too; only with "c", "arduino" and "rust".

    Raises Error if the format does not support what is exported or an option, or if an NXT cannot run the program.
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
