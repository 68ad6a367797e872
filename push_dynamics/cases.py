"""
Many cases of a push at given commands: one compiled loop over cases and steps.

Every step is that of ``push_dynamics.step``. Parameters, states and commands of the cases are
arrays with a row for each case, in the order of ``layout``.
"""

import dataclasses
import enum
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from push_dynamics.compiled import closest_on_polygon, compiled
from push_dynamics.contact_law import nearest_points
from push_dynamics.layout import (
    A_OMEGA, A_X, A_Y, CAPACITY, COM_X, COM_Y, DISC_RADIUS, LOAD_RATIO, MODE, OMEGA,
    PLAIN_CAPACITY, ROBOT_RADIUS, ROBOT_THETA, ROBOT_X, ROBOT_Y, SEPARATE, SMOOTHING_SPEED, THETA,
    V_X, V_Y, X, Y,
)
from push_dynamics.step import step, step_count
from push_model.geometry import FloatArray


class CaseEnd(enum.IntEnum):
    """How a case ended."""

    NOT_RUN = 0
    # All commands were driven.
    COMPLETED = 1
    # The robot had touched the object and left it: nothing more comes of it.
    LOST = 2
    # Its parameters are not possible: it has not been run.
    REFUSED = 3


# What compiled code reads.
_COMPLETED, _LOST, _REFUSED = (int(end) for end in (CaseEnd.COMPLETED, CaseEnd.LOST,
                                                    CaseEnd.REFUSED))


@dataclasses.dataclass(frozen=True)
class CaseArrays:
    """
    Cases of a push: n cases on k supports, with m commands each and q patches of floor.

    :param states: at the start, shape (n, 28); are written.
    :param bodies: shape (n, 11).
    :param supports: shape (n, k, 8); are written.
    :param capacities: friction of the supports under their loads at rest, shape (n, k) [N].
    :param outline: vertices in the object frame, of all cases, shape (v, 2) [m].
    :param floors: rows of ``floor.floor_rows``, shape (n, q, 8).
    :param drives: shape (n, 3).
    :param durations: of the commands, 0 for one that is left out, shape (n, m) [s].
    :param requested: commands before the limits of the drive, shape (n, m, 3).
    :param commands: within the limits, shape (n, m, 3).
    :param factors: on the friction of the supports from a command on, nan for those before, shape
        (n, m, k).
    :param ends: ``CaseEnd``, shape (n,); those refused are left out, the others are written.
    :param times: when the cases ended, shape (n,) [s]; are written.
    """

    states: FloatArray
    bodies: FloatArray
    supports: FloatArray
    capacities: FloatArray
    outline: FloatArray
    floors: FloatArray
    drives: FloatArray
    durations: FloatArray
    requested: FloatArray
    commands: FloatArray
    factors: FloatArray
    ends: NDArray[np.uint8]
    times: FloatArray

    def run(self, longest: float, lost_gap: float) -> None:
        """
        Run all cases that are not refused.

        :param longest: step [s].
        :param lost_gap: distance at which the robot has left an object that rests [m].
        """
        forces = np.zeros(2 * self.supports.shape[1])
        run_cases(self.states, self.bodies, self.supports, self.capacities, self.outline,
                  self.floors, forces, self.drives, self.durations, self.requested, self.commands,
                  self.factors, self.ends, self.times, longest, lost_gap)


@compiled
def forget_acceleration(state: Any) -> None:
    """Let the acceleration of the last step predict nothing, as commands or friction jump."""
    state[A_X] = 0.0
    state[A_Y] = 0.0
    state[A_OMEGA] = 0.0


@compiled
def change_friction(supports: Any, capacities: Any, factors: Any) -> None:
    """
    Multiply the friction of the supports, whose loads become those at rest.

    :param supports: rows of one case, are written.
    :param capacities: under the loads at rest [N].
    :param factors: one for each support.
    """
    for i in range(len(supports)):
        supports[i][CAPACITY] = factors[i] * capacities[i]
        supports[i][PLAIN_CAPACITY] = factors[i] * capacities[i]
        supports[i][LOAD_RATIO] = 1.0


@compiled
def is_lost(state: Any, body: Any, outline: Any, lost_gap: float) -> bool:
    """
    Tell whether the object rests, but for creeping, and the robot is farther away than a gap.

    :param lost_gap: the gap [m].
    """
    if state[MODE] != SEPARATE or math.isinf(lost_gap):
        return False
    for i in (V_X, V_Y, OMEGA):
        if abs(state[i]) > body[SMOOTHING_SPEED]:
            return False
    c, s = math.cos(state[THETA]), math.sin(state[THETA])
    nearest = nearest_points(
        outline, body[DISC_RADIUS], body[ROBOT_RADIUS],
        state[X] - c * body[COM_X] + s * body[COM_Y], state[Y] - s * body[COM_X] - c * body[COM_Y],
        state[THETA], state[ROBOT_X], state[ROBOT_Y], state[ROBOT_THETA])
    return nearest.gap > lost_gap


@compiled
def run_case(state: Any, body: Any, supports: Any, capacities: Any, outline: Any, floor: Any,
             forces: Any, drive: Any, durations: Any, requested: Any, commands: Any, factors: Any,
             longest: float, lost_gap: float) -> tuple[float, int]:
    """
    Run one case; arguments are rows of ``CaseArrays``, ``forces`` is scratch.

    :return: (time at its end [s], ``CaseEnd``).
    """
    time = 0.0
    has_touched = False
    v_x, v_y, omega = 0.0, 0.0, 0.0
    for j in range(len(durations)):
        if durations[j] == 0.0:
            continue
        if not math.isnan(factors[j][0]):
            change_friction(supports, capacities, factors[j])
            forget_acceleration(state)
        if requested[j][0] != v_x or requested[j][1] != v_y or requested[j][2] != omega:
            forget_acceleration(state)
            v_x, v_y, omega = requested[j][0], requested[j][1], requested[j][2]
        count = step_count(durations[j], longest)
        h = durations[j] / count
        for k in range(count):
            step(state, body, supports, outline, floor, forces, commands[j], drive, h)
            has_touched = has_touched or state[MODE] != SEPARATE
            if has_touched and is_lost(state, body, outline, lost_gap):
                return time + (k + 1) * h, _LOST
        time += durations[j]
    return time, _COMPLETED


@compiled
def run_cases(states: Any, bodies: Any, supports: Any, capacities: Any, outline: Any, floors: Any,
              forces: Any, drives: Any, durations: Any, requested: Any, commands: Any,
              factors: Any, ends: Any, times: Any, longest: float, lost_gap: float) -> None:
    """Run all cases that are not refused; see ``CaseArrays``, ``forces`` is scratch."""
    for i in range(len(states)):
        if ends[i] != _REFUSED:
            times[i], ends[i] = run_case(
                states[i], bodies[i], supports[i], capacities[i], outline, floors[i], forces,
                drives[i], durations[i], requested[i], commands[i], factors[i], longest, lost_gap)


@compiled
def write_distances(outline: Any, x: Any, y: Any, distances: Any) -> None:
    """
    Write the signed distances of points from a convex polygon, negative inside.

    :param outline: its vertices, counter-clockwise, shape (v, 2) [m].
    :param x: of the points, shape (n,) [m].
    :param y: of the points, shape (n,) [m].
    :param distances: shape (n,) [m], are written.
    """
    for i in range(len(distances)):
        distances[i] = closest_on_polygon(outline, x[i], y[i])[4]
