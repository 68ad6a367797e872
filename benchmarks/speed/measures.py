"""
Ratios of speeds, each measured in one run: what is done over what it could cost at least.

CPU times of this process or of its children count, so that other programs on the machine change
little; what runs in several processes at once is measured by the clock.
"""

from collections.abc import Callable, Sequence
import os
from pathlib import Path
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

from benchmarks.controller.timing import timed
from benchmarks.nodes import resident_memory
import numpy as np
from push_model.files.data import config_file
from push_model.geometry import Pose
from push_model.plan_request import PlanRequest
from push_model.signals import Twist
from push_mujoco.velocity_robot import MujocoPlant
from push_planner.straight.planner import plan_straight_push
from push_scenario import load_scenario, read_object, read_robot, simulate

# Pushes whose controller steps are timed, kind and seed of ``benchmarks.controller.cases``;
# chosen: of either drive, planned to take less than ``MAX_TIMED``.
PUSHES = (('box, differential', 2), ('box, holonomic', 1))
# Duration over which steps of MuJoCo are timed [s]; chosen: a push.
MUJOCO_TIME = 2.0
DEMO = 'task_demo'
# Plans after which memory is compared with that after the last one; chosen: all code is loaded.
FIRST_PLANS = 10
# Calls that run in processes of their own.
IMPORT = ('-c', 'import push_planner')
LIST = ('-m', 'push_scenario.cli', '--list')
NOTHING = ('-c', 'pass')
NODES = {'controller': 'push_control.controller_node', 'planner': 'push_planner.planner_node',
         'sim': 'push_sim_node.sim_node'}


class ControlSpeed(NamedTuple):
    """
    CPU times of a step of the controller.

    :param over_mujoco: median step of the feedback law with its filter, over a MuJoCo step.
    :param mpc_over_feedback: median step with the mpc law over that with the feedback law.
    """

    over_mujoco: float
    mpc_over_feedback: float


def median(measure: Callable[[], float], count: int) -> float:
    """
    Repeat a measurement.

    :param measure: what to repeat.
    :param count: how often.
    :return: the median.
    """
    return statistics.median(measure() for _ in range(count))


def control_speed() -> ControlSpeed:
    """Time whole steps of the controller in the closed loop, and steps of MuJoCo."""
    steps: dict[str, list[float]] = {'feedback': [], 'mpc': []}
    for kind, seed in PUSHES:
        for law, times in steps.items():
            timed_push = timed(kind, seed, law)
            times += [] if timed_push is None else timed_push.steps
    feedback, mpc = (statistics.median(times) for times in steps.values())
    return ControlSpeed(feedback / mujoco_step(), mpc / feedback)


def mujoco_step() -> float:
    """Time a step of MuJoCo at its defaults, of a robot that pushes a box [s]."""
    obj = read_object(config_file('objects/box_04.yaml'))
    robot = read_robot(config_file('robots/disc_017.yaml'))
    start = Pose(min(x for x, _ in obj.outline) - robot.radius, 0.0, 0.0)
    plant = MujocoPlant(obj, robot, Pose(0.0, 0.0, 0.0), start, steps_per_command=20)
    # The first command loads and compiles what commands of the drive take.
    plant.advance(plant.engine.step, Twist(0.1, 0.0, 0.0))
    began = time.process_time()
    plant.advance(MUJOCO_TIME, Twist(0.1, 0.0, 0.0))
    return (time.process_time() - began) / (MUJOCO_TIME / plant.engine.step)


def task_speed() -> float:
    """Compare simulated time of the demo with the CPU time that it takes in one process."""
    scenario = load_scenario(DEMO)
    began = time.process_time()
    result = simulate(scenario, planning_time=0.0)
    passed = time.process_time() - began
    if result.tape is None:
        raise RuntimeError(f'{DEMO}: got no tape, expected that something moved')
    return float(result.tape['time'][-1]) / passed


def replay_speed() -> float:
    """Compare simulated time of the demo with the time that it takes in lockstep over DDS."""
    # Imported here: everything else works without ROS.
    from push_scenario.dds.replay import run_over_dds
    scenario = load_scenario(DEMO)
    with tempfile.TemporaryDirectory() as folder:
        result = run_over_dds(scenario, scenario.control.control_law, Path(folder), record=False)
    if result.timing is None:
        raise RuntimeError(f'{DEMO}: got no timing, expected a run over DDS')
    return result.timing.speed_up


def process_time(words: Sequence[str]) -> float:
    """
    Measure the CPU time of a process of Python, that of Python itself included [s].

    :param words: its command line.
    :raises RuntimeError: where it fails.
    """
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([sys.executable, *words], stdout=subprocess.DEVNULL, check=False)
    if done.returncode != 0:
        raise RuntimeError(f'{words}: got exit status {done.returncode}, expected 0')
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def memory_growth(plans: int) -> float:
    """
    Plan pushes to goals all around, and compare the memory of this process.

    :param plans: their number.
    :return: memory after all over that after the first ones.
    """
    scenario = load_scenario(DEMO)
    task = scenario.task
    assert task is not None
    rng = np.random.default_rng(1)
    first = 0.0
    for index in range(plans):
        goal = Pose(*rng.uniform((0.3, -1.5, -3.0), (1.5, 1.5, 3.0)).tolist())
        plan_straight_push(PlanRequest(Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.0, 0.0), goal,
                                       scenario.object), scenario.robot, drive=task.drive)
        if index + 1 == FIRST_PLANS:
            first = resident_memory(os.getpid())
    return resident_memory(os.getpid()) / first
