"""Correcting pushes, in histories whose times are known."""

import numpy as np
from push_control.task.status import StateChange, TaskState
from push_model.geometry import Pose
from push_scenario.evaluation.corrections import correcting_pushes, push_intervals
from push_sim_node.tape import Tape


def history_of(*changes):
    """Return a history from (time, state)."""
    return [StateChange(time, state, '') for time, state in changes]


def test_the_time_to_mend_a_miss_is_per_correcting_push():
    """From the end of the first push that ended near the goal to the end of the last one."""
    history = history_of((0.0, TaskState.PLAN), (1.0, TaskState.PUSH), (10.0, TaskState.RETREAT),
                         (15.0, TaskState.PUSH), (16.0, TaskState.PLAN), (20.0, TaskState.PUSH),
                         (22.0, TaskState.RETREAT), (24.0, TaskState.DONE))
    assert push_intervals(history, 24.0) == [(1.0, 10.0), (15.0, 16.0), (20.0, 22.0)]
    goal = Pose(1.0, 0.0, 0.1)
    columns = ('time', 'object_x', 'object_y', 'object_theta')

    def tape(second, third):
        return Tape(columns, np.array([(0.0, 0.0, 0.0, 0.0), (15.0, second, 0.0, 0.0),
                                       (20.0, third, 0.0, 0.0), (24.0, 1.0, 0.0, 0.1)]))

    assert correcting_pushes(history, 24.0, tape(0.95, 0.99), goal) == (2, 12.0)
    assert correcting_pushes(history, 24.0, tape(0.9, 0.99), goal) == (1, 6.0)
    assert correcting_pushes(history, 24.0, tape(0.9, 0.93), goal) == (0, 0.0)
    turned = goal._replace(theta=0.2)
    assert correcting_pushes(history, 24.0, tape(0.95, 0.99), turned) == (0, 0.0)
