"""How hard, how deep and for how long object and robot touch walls."""

from benchmarks.controller.tables import Record
import numpy as np
from push_base.push_force import needed_force
from push_model.geometry import BoolArray, FloatArray
from push_model.parameters import PushedObject
from push_sim_node.tape import Tape

# Force of walls on the object, over that which slides it along the floor, from which on it counts
# as pressed onto them; chosen: a robot that pushes along a wall or squares an object there pushes
# about twice as hard as on open floor.
PRESSED_RATIO = 2.0


def wall_record(tape: Tape, obj: PushedObject) -> Record:
    """
    Gather what walls do.

    :param tape: of a run with walls.
    :param obj: the true ``PushedObject``.
    :return: greatest ``wall_force`` on the object [N], longest press beyond ``PRESSED_RATIO``,
        ``pressed`` [s], greatest ``wall_depth`` of the object [m], longest touch of the robot,
        ``robot_at_wall`` [s].
    """
    column = {name: tape.rows[:, tape.columns.index(name)] for name in (
        'time', 'wall_force_x', 'wall_force_y', 'wall_depth', 'robot_at_wall')}
    force = np.hypot(column['wall_force_x'], column['wall_force_y'])
    time = column['time']
    return {'wall_force': float(force.max()),
            'pressed': longest(time, force > PRESSED_RATIO * needed_force(obj)),
            'wall_depth': float(column['wall_depth'].max()),
            'robot_at_wall': longest(time, column['robot_at_wall'] > 0.0)}


def longest(time: FloatArray, holds: BoolArray) -> float:
    """
    Find for how long a condition holds without a break [s].

    :param time: of the rows, shape (n,) [s].
    :param holds: whether it does at each of them, shape (n,).
    """
    best = elapsed = 0.0
    for step, is_met in zip(np.diff(time, append=time[-1]).tolist(), holds.tolist()):
        elapsed = elapsed + step if is_met else 0.0
        best = max(best, elapsed)
    return best
