"""Environment of Gymnasium: its interface, its rewards, and what chance decides."""

import dataclasses
import math

from helpers.extras import import_extra
import numpy as np
from push_model.geometry import Pose
from push_scenario import load_scenario
import pytest

gymnasium = import_extra('gymnasium', 'gym')
environment = import_extra('gymnasium', 'gym', 'push_scenario.gym')

# Unlike all that is drawn: the robot touches the object at once.
NEAR = {'object': (0.0, 0.0, 0.0), 'robot': (-0.38, 0.0, 0.0), 'goal': (0.6, 0.1, 0.4)}
AHEAD = np.array([0.2, 0.0], np.float32)


def episode(task, actions, **reset):
    """Return the observations and rewards of an episode."""
    observations = [task.reset(**reset)[0]]
    rewards = []
    for action in actions:
        observation, reward, *_ = task.step(action)
        observations.append(observation)
        rewards.append(reward)
    return np.array(observations), np.array(rewards)


@pytest.mark.filterwarnings('ignore:.*Box')
@pytest.mark.parametrize('scenario', ['task_approach', 'task_near'])  # of either drive
def test_it_passes_the_checker_of_gymnasium(scenario):
    task = gymnasium.make('push_control/PushTask-v0', scenario=scenario, render_mode='rgb_array')
    import_extra('gymnasium', 'gym', 'gymnasium.utils.env_checker').check_env(task.unwrapped)
    picture = task.unwrapped.render()
    assert picture.shape == (400, 400, 3) and picture.dtype == np.uint8 and np.ptp(picture) > 0


def test_a_seed_decides_everything():
    actions = np.random.default_rng(1).uniform(-0.3, 0.3, (20, 2)).astype(np.float32)
    tasks = [environment.PushTask(is_noisy=True) for _ in range(2)]
    (one, _), (two, _) = (episode(task, actions, seed=5) for task in tasks)
    other, _ = episode(tasks[0], actions, seed=6)
    assert one.tobytes() == two.tobytes() and not np.array_equal(one, other)
    # The next episode is another one, without another seed.
    assert not np.array_equal(one[0], tasks[0].reset()[0])


@pytest.mark.parametrize('is_noisy', [False, True])
def test_a_seed_decides_the_noise_where_there_is_any(is_noisy):
    task = environment.PushTask(is_noisy=is_noisy)
    one, other = (episode(task, [AHEAD] * 5, seed=seed, options=NEAR)[0] for seed in (5, 6))
    assert np.array_equal(one, other) != is_noisy


def test_rewards_sum_up_to_the_way_that_was_gained():
    task = environment.PushTask()
    task.reset(options=NEAR)
    start = task.goal_distance
    _, rewards = episode(task, [AHEAD] * 25, options=NEAR)
    assert rewards.sum() == pytest.approx(start - task.goal_distance)
    assert rewards.sum() > 0.1


def test_the_distance_of_a_rotation_is_that_of_its_farthest_support():
    task = environment.PushTask()
    task.reset(options={**NEAR, 'goal': (0.0, 0.0, 0.4)})
    arm = max(math.hypot(support.x, support.y) for support in task.scenario.object.supports)
    assert task.goal_distance == pytest.approx(2.0 * arm * math.sin(0.2))


def test_nothing_depends_on_where_the_world_has_its_origin():
    motion, task = Pose(3.0, -2.0, 1.2), environment.PushTask()
    moved = {name: motion @ Pose(*pose) for name, pose in NEAR.items()}
    here, there = (episode(task, [AHEAD] * 20, options=options) for options in (NEAR, moved))
    assert np.allclose(here[0], there[0], atol=1e-5) and np.allclose(here[1], there[1], atol=1e-6)


def test_an_object_at_rest_at_its_goal_ends_an_episode():
    task = environment.PushTask()
    task.reset(options={**NEAR, 'robot': (-1.0, 0.0, 0.0), 'goal': (0.0, 0.0, 0.0)})
    _, reward, terminated, truncated, info = task.step(0.0 * AHEAD)
    assert (reward, terminated, truncated) == (1.0, True, False) and info['is_success']


def test_time_is_limited():
    scenario = dataclasses.replace(load_scenario('task_approach'), time_limit=2.0)
    task = environment.PushTask(scenario, period=0.4)
    task.reset(seed=1)
    ends = [task.step(0.0 * AHEAD)[2:4] for _ in range(5)]
    assert set(ends[:-1]) == {(False, False)} and ends[-1] == (False, True)


@pytest.mark.slow
@pytest.mark.parametrize('is_noisy', [False, True])
def test_planner_and_controller_of_the_package_do_the_task(is_noisy):
    task = environment.PushTask(is_noisy=is_noisy)
    _, info = task.reset(seed=2)
    start, total, is_over = task.goal_distance, 0.0, False
    policy = environment.PackagePolicy(task.scenario, info)
    while not is_over:
        _, reward, terminated, truncated, info = task.step(policy.action(info))
        total, is_over = total + reward, terminated or truncated
    assert info['is_success'] and 0.0 < start + 1.0 - total < 0.02


@pytest.mark.parametrize('arguments, expected', [
    ({'scenario': 'straight_push'}, 'got straight_push, a single push, expected a task'),
    ({'render_mode': 'human'}, "got 'human', expected rgb_array"),
    ({'period': 0.0}, 'got 0.0, expected above 0 and below command_timeout'),
])
def test_what_it_cannot_be_is_refused(arguments, expected):
    with pytest.raises(ValueError, match=expected):
        environment.PushTask(**arguments)


def test_wrong_actions_and_options_are_refused():
    task = environment.PushTask(load_scenario('task_approach'))
    with pytest.raises(ValueError, match='options: got box, expected object, robot and goal'):
        task.reset(options={'box': (0.0, 0.0, 0.0)})
    with pytest.raises(ValueError, match='expected one beside it'):
        task.reset(options={**NEAR, 'robot': (0.0, 0.0, 0.0)})
    for action in ([0.1, math.nan], [0.1]):
        with pytest.raises(ValueError, match='expected 2 finite numbers'):
            task.step(np.array(action))
