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
from benchmarks.plant.batch import draw, PUSH
from benchmarks.plant.mujoco_scene import MujocoPlant
import numpy as np
from push_model.geometry import Pose
from push_model.plan_request import PlanRequest
from push_model.signals import Twist
from push_planner.primitive_push.planner import plan_primitive_push
from push_scenario import load_scenario, run_pushes, simulate, simulate_cases
from push_scenario.batch.case_arrays import CaseEncoder

# Pushes whose controller steps are timed, kind and seed of ``benchmarks.controller.cases``;
# chosen: of either drive, planned to take less than ``LONGEST_TIMED``.
PUSHES = (('box, differential', 2), ('box, holonomic', 1))
# Duration over which steps of MuJoCo are timed [s]; chosen: a push.
MUJOCO_TIME = 2.0
DEMO = 'task_demo'
# Of so many cases of a batch the bare steps of one are timed; chosen: enough for 1 %.
BARE_PART = 4
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


class BatchSpeed(NamedTuple):
    """
    Speed of a batch of short pushes.

    :param over_bare: steps per second of CPU time of one process over those of the compiled steps
        alone.
    :param two_over_one: wall time of one process over that of two, their start included.
    :param two_over_one_idle: the same by CPU times, as if no other program ran: of one process
        over that of the process that starts the two, and of one of these.
    """

    over_bare: float
    two_over_one: float
    two_over_one_idle: float


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
            found = timed(kind, seed, law)
            times += [] if found is None else found.steps
    feedback, mpc = (statistics.median(times) for times in steps.values())
    return ControlSpeed(feedback / mujoco_step(), mpc / feedback)


def mujoco_step() -> float:
    """Time a step of MuJoCo at its defaults, of a robot that pushes a box [s]."""
    start = Pose(*PUSH.robot_pose)
    plant = MujocoPlant(PUSH.object, PUSH.robot, Pose(0.0, 0.0, 0.0), start, steps_per_command=20)
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


def batch_speed(count: int) -> BatchSpeed:
    """
    Time a batch in one process and in two, and the compiled steps alone.

    :param count: number of cases.
    """
    simulate_cases(PUSH, draw(np.random.default_rng(0), 1))
    with tempfile.TemporaryDirectory() as folder:
        one, two = (_timed_batch(count, Path(folder) / f'{workers}.npy', workers)
                    for workers in (1, 2))
    bare = bare_time(count // BARE_PART) * BARE_PART
    return BatchSpeed(bare / one.cpu, one.wall / two.wall,
                      one.cpu / (two.cpu + two.children_cpu / 2))


class _Times(NamedTuple):
    """Wall time, CPU time of this process, and that of those that it has started [s]."""

    wall: float
    cpu: float
    children_cpu: float


def _timed_batch(count: int, out: Path, workers: int) -> _Times:
    """Time a batch of pushes, from the call to the end of its processes."""
    before, began = os.times(), time.perf_counter()
    run_pushes(PUSH, draw, count, out, workers=workers)
    wall, after = time.perf_counter() - began, os.times()
    return _Times(wall, after.user + after.system - before.user - before.system,
                  after.children_user + after.children_system - before.children_user
                  - before.children_system)


def bare_time(count: int) -> float:
    """
    Measure the CPU time of the compiled steps of some cases, their arrays made before [s].

    :param count: number of cases.
    """
    columns = PUSH.columns(draw(np.random.default_rng(1), count))
    arrays = CaseEncoder(PUSH, columns).encode().arrays
    began = time.process_time()
    arrays.run(PUSH.step, PUSH.lost_gap)
    return time.process_time() - began


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
    for number in range(plans):
        goal = Pose(*rng.uniform((0.3, -1.5, -3.0), (1.5, 1.5, 3.0)).tolist())
        plan_primitive_push(PlanRequest(Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.0, 0.0), goal,
                                        scenario.object), scenario.robot, drive=task.drive)
        if number + 1 == FIRST_PLANS:
            first = resident_memory()
    return resident_memory() / first


def resident_memory() -> float:
    """Read the resident memory of this process [B], as Linux counts it."""
    pages = int(Path('/proc/self/statm').read_text(encoding='ascii').split()[1])
    return pages * os.sysconf('SC_PAGE_SIZE')
