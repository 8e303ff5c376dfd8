"""A simulated robot as an environment of Gymnasium, for reinforcement learning. It needs the package gymnasium."""

from collections.abc import Mapping
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import Error, SimulatedRobot, Simulator

try:
    import gymnasium
    from gymnasium import spaces
except ModuleNotFoundError:
    raise ModuleNotFoundError("mindgap.env needs gymnasium: pip install 'mindgap[gymnasium]'") from None

REACHED_REWARD = 100.0
"""Reward for reaching the target."""
CRASHED_REWARD = -100.0
"""Reward for touching something."""

_SEEDS = 2**63


class RobotEnv(gymnasium.Env[Any, NDArray[np.float32]]):
    """A simulated robot that drives to the target of a scene.

    An observation is what a controller of `mindgap.rollout` sees, as arrays of shape (1,): `x_cm`, `y_cm`, `heading_deg`
    (-180 to 180), and `echo_cm`. If the sensor gave no value, `has_echo` is 0 and `echo_cm` the sensor's `max_cm`. An action is
    the left and the right command, -100 to 100, for one step of the robot.

    The reward of a step is the distance in cm by which the robot came nearer to the target, plus REACHED_REWARD at the target,
    plus CRASHED_REWARD if it touched something. Both terminate the episode; the target is reached within 15 cm. An episode is
    truncated after `steps` steps. `info` has `t_ms`, `distance_cm` (to the target), `reached` and `crashed`.

    `reset(seed=N)` begins the run of `mindgap.rollout` with that seed. Further episodes follow from it.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        simulator: Simulator,
        scene: str | PathLike[str] | Mapping[str, Any],
        *,
        start: int = 1,
        steps: int = 100,
    ) -> None:
        """Makes an environment.

        simulator: the simulator, whose robot has a range sensor.
        scene: path of scene.toml, or a dict with its contents, which has a target and starts.
        start: number of the start in the scene, from 1.
        steps: an episode is truncated after this number of steps.

        Raises mindgap.Error if the scene has no target or no such start, or if the simulator lacks a network.
        """
        self._robot = SimulatedRobot(simulator, scene, start=start)
        if self._robot.distance_cm is None:
            raise Error("the scene has no [target], on which the reward depends")
        self._simulator, self._scene, self._start, self._steps = simulator, scene, start, steps
        self._steps_left = steps
        sensor = simulator.robot["ultrasonic"]
        self._max_cm: float = sensor["max_cm"]
        arena = self._robot.scene.get("arena")
        observed: dict[str, spaces.Space[NDArray[Any]]] = {
            "x_cm": spaces.Box(0.0, arena["width_cm"], (1,)) if arena else spaces.Box(-np.inf, np.inf, (1,)),
            "y_cm": spaces.Box(0.0, arena["height_cm"], (1,)) if arena else spaces.Box(-np.inf, np.inf, (1,)),
            "heading_deg": spaces.Box(-180.0, 180.0, (1,)),
            "echo_cm": spaces.Box(sensor["min_cm"], sensor["max_cm"], (1,)),
            "has_echo": spaces.MultiBinary(1),
        }
        self.observation_space = spaces.Dict(observed)
        self.action_space = spaces.Box(-100.0, 100.0, (2,))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        """Places the robot at rest at the start; returns the observation and `info`."""
        super().reset(seed=seed)
        if seed is None:
            seed = int(self.np_random.integers(_SEEDS))
        self._robot = SimulatedRobot(self._simulator, self._scene, start=self._start, seed=seed)
        self._steps_left = self._steps
        return self._observation(), self._info()

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[dict[str, NDArray[Any]], float, bool, bool, dict[str, Any]]:
        """Drives for one step; returns observation, reward, terminated, truncated and `info`.

        Raises mindgap.Error if a command lies outside -100 to 100.
        """
        robot, before_cm = self._robot, self._distance_cm()
        left, right = action
        robot.drive(left, right)
        self._steps_left -= 1
        reward = before_cm - self._distance_cm() + REACHED_REWARD * bool(robot.reached) + CRASHED_REWARD * robot.crashed
        terminated = bool(robot.reached) or robot.crashed
        return self._observation(), reward, terminated, self._steps_left <= 0, self._info()

    def _distance_cm(self) -> float:
        distance_cm = self._robot.distance_cm
        assert distance_cm is not None, "the scene has a target"
        return distance_cm

    def _observation(self) -> dict[str, NDArray[Any]]:
        seen = self._robot.seen
        echo_cm = seen["echo_cm"]
        has_echo = echo_cm is not None
        values = {name: seen[name] for name in ("x_cm", "y_cm", "heading_deg")}
        values["echo_cm"] = echo_cm if has_echo else self._max_cm
        observation: dict[str, NDArray[Any]] = {name: np.array([value], np.float32) for name, value in values.items()}
        return observation | {"has_echo": np.array([has_echo], np.int8)}

    def _info(self) -> dict[str, Any]:
        robot = self._robot
        return {
            "t_ms": robot.seen["t_ms"],
            "distance_cm": robot.distance_cm,
            "reached": robot.reached,
            "crashed": robot.crashed,
        }
