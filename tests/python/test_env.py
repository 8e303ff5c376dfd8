"""Tests the environment of Gymnasium."""

import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import mindgap
from mindgap.env import CRASHED_REWARD, REACHED_REWARD, RobotEnv

SCENE = {
    "arena": {"width_cm": 200, "height_cm": 150},
    "target": {"x_cm": 160, "y_cm": 75},
    "start": [{"x_cm": 40, "y_cm": 75, "heading_deg": 0}, {"x_cm": 40, "y_cm": 75, "heading_deg": 180}],
}


@pytest.fixture(scope="module")
def simulator():
    return mindgap.train(mindgap.record(runs=12, steps=40, seed=1))


def episode(environment, policy, **reset):
    """Returns the observations, rewards and last step of an episode."""
    observation, _ = environment.reset(**reset)
    observations, rewards = [observation], []
    while True:
        step = environment.step(np.array(policy(observation), np.float32))
        observation, reward, terminated, truncated, _ = step
        observations.append(observation)
        rewards.append(reward)
        if terminated or truncated:
            return observations, rewards, step


def straight(observation):
    return 60, 60


def test_checker_of_gymnasium_finds_nothing(simulator):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Commands are in percent, as everywhere in Mindgap; RescaleAction offers -1 to 1.
        warnings.filterwarnings("ignore", message=".*recommend using a symmetric.*")
        check_env(RobotEnv(simulator, SCENE, steps=20), skip_render_check=True)


def test_same_seed_gives_the_same_episodes_which_are_those_of_rollout(simulator):
    environment = RobotEnv(simulator, SCENE, start=2, steps=4)
    turning = lambda observation: (30, -30)
    first, again = (episode(environment, turning, seed=7)[0] for _ in range(2))
    next_one = episode(environment, turning)[0]
    assert all(np.array_equal(a[name], b[name]) for a, b in zip(first, again, strict=True) for name in a)
    assert any(a["x_cm"] != b["x_cm"] for a, b in zip(first, next_one, strict=True))
    run = mindgap.rollout(simulator, turning, SCENE, start=2, steps=4, seed=7)
    for observation, (_, row) in zip(first, run.iterrows(), strict=True):
        for name in ["x_cm", "y_cm", "heading_deg"]:
            assert observation[name] == pytest.approx(row[name], abs=1e-3)
        assert observation["has_echo"] == (not np.isnan(row["echo_cm"]))
        max_cm = simulator.robot["ultrasonic"]["max_cm"]
        assert observation["echo_cm"] == pytest.approx(row["echo_cm"] if observation["has_echo"] else max_cm)


def test_reward_is_the_way_to_the_target_and_the_end_of_it(simulator):
    observations, rewards, (_, _, terminated, truncated, info) = episode(RobotEnv(simulator, SCENE), straight, seed=1)
    assert terminated and not truncated and info["reached"] and not info["crashed"]
    assert info["distance_cm"] <= 15.0 and info["t_ms"] == len(rewards) * simulator.robot["step_ms"]
    assert sum(rewards) == pytest.approx(120.0 - info["distance_cm"] + REACHED_REWARD)
    _, rewards, (_, _, terminated, _, info) = episode(RobotEnv(simulator, SCENE, start=2), straight, seed=1)
    assert terminated and info["crashed"] and not info["reached"]
    assert sum(rewards) == pytest.approx(120.0 - info["distance_cm"] + CRASHED_REWARD)
    _, rewards, (_, _, terminated, truncated, _) = episode(RobotEnv(simulator, SCENE, steps=3), lambda _: (0, 0), seed=1)
    assert not terminated and truncated and rewards == [0.0] * 3


def test_wrappers_and_vectors_of_gymnasium_fit(simulator):
    wrapped = gymnasium.wrappers.RescaleAction(RobotEnv(simulator, SCENE), -1.0, 1.0)
    sonar = gymnasium.wrappers.FlattenObservation(gymnasium.wrappers.FilterObservation(wrapped, ["echo_cm", "has_echo"]))
    assert sonar.reset(seed=1)[0].shape == (2,)
    assert sonar.step(np.ones(2, np.float32))[0].shape == (2,)
    several = gymnasium.vector.SyncVectorEnv([lambda: RobotEnv(simulator, SCENE)] * 3)
    observations, _ = several.reset(seed=1)
    assert observations["x_cm"].shape == (3, 1)
    several.close()


def test_bad_input_is_one_line(simulator):
    with pytest.raises(mindgap.Error, match="no .target."):
        RobotEnv(simulator, {name: table for name, table in SCENE.items() if name != "target"})
    with pytest.raises(mindgap.Error, match="start 3"):
        RobotEnv(simulator, SCENE, start=3)
    environment = RobotEnv(simulator, SCENE)
    environment.reset(seed=1)
    with pytest.raises(mindgap.Error, match="step 0: commands 101 and 0"):
        environment.step(np.array([101, 0], np.float32))


def test_mindgap_itself_does_not_import_gymnasium():
    script = """
import sys, mindgap
assert "gymnasium" not in sys.modules
sys.modules["gymnasium"] = None
try:
    import mindgap.env
except ModuleNotFoundError as missing:
    assert "pip install 'mindgap[gymnasium]'" in str(missing)
else:
    raise AssertionError("it was imported without gymnasium")
"""
    subprocess.run([sys.executable, "-c", script], check=True)
