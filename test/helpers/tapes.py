"""Tapes of simple motions, for tests of what is made of tapes."""

import dataclasses
import math

import numpy as np
from numpy.typing import ArrayLike
from push_model.geometry import Pose
from push_model.trajectory import PushTrajectory
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.placement import Placement
from push_scenario.simulation.history import single_push_history
from push_scenario.simulation.result import Outcome, RunResult
from push_sim_node.tape import Tape
from push_sim_node.tape_row import COLUMNS

TIMES = np.linspace(0.0, 10.0, 501)


def make_tape(**columns: ArrayLike) -> Tape:
    """Tape over ``TIMES`` whose other columns are 0."""
    rows = np.zeros((len(TIMES), len(COLUMNS)))
    for name, values in {'time': TIMES, **columns}.items():
        rows[:, COLUMNS.index(name)] = values
    return Tape(COLUMNS, rows)


def straight_plan(length: float = 2.0, heading: float = 0.0,
                  origin: tuple[float, float] = (0.0, 0.0)) -> PushTrajectory:
    """Plan a push straight ahead from an origin; the robot does not move in it."""
    distance = np.linspace(0.0, length, 21)
    poses = np.column_stack([origin[0] + distance * math.cos(heading),
                             origin[1] + distance * math.sin(heading), np.full(21, heading)])
    return PushTrajectory(np.linspace(0.0, 10.0, 21), *([poses, np.zeros((21, 3))] * 3))


def make_result(tape: Tape, plan: PushTrajectory, goal: Pose,
                outcome: Outcome = Outcome.DONE) -> RunResult:
    """Run of the straight scenario with another goal."""
    scenario = dataclasses.replace(load_scenario('straight_push'),
                                   goal=Placement(*goal))
    return RunResult(scenario, 'feedback', outcome, '', tape, 9.0,
                     single_push_history(outcome, '', 9.0), plan=plan)
