"""Commands change no faster than a base follows which accelerates less than stated."""

import math

import numpy as np
from push_base.command_ramp import CommandRamp, MAX_GAP
from push_model.base_knowledge import ACCELERATION_MARGIN, BaseKnowledge
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
import pytest

PERIOD = 0.02
ROBOT = RoundRobot(0.17, drive='holonomic', max_acceleration=0.9, max_yaw_acceleration=6.0)
SLOW = BaseKnowledge(max_acceleration=0.3, max_yaw_acceleration=2.0)
FAST = Twist(0.2, -0.1, 1.0)


def ramped(commands, knowledge=SLOW):
    """List what is sent of commands, one each period."""
    ramp = CommandRamp(ROBOT)
    return [ramp.limit(command, knowledge, PERIOD * k) for k, command in enumerate(commands)]


@pytest.mark.parametrize('knowledge', [BaseKnowledge(), BaseKnowledge(dead_time=0.2),
                                       BaseKnowledge(max_acceleration=2.0)])
def test_commands_of_a_base_that_accelerates_as_stated_pass(knowledge):
    """They are the same values, whatever jumps they make."""
    commands = [STOP, FAST, STOP, Twist(-0.3, 0.3, -1.9)]
    assert all(sent is command for sent, command in zip(ramped(commands, knowledge), commands))


def test_no_change_is_quicker_than_the_base():
    """In any direction, and each change is used up until the command is reached."""
    commands = [STOP] * 5 + [FAST] * 100 + [STOP] * 100 + [Twist(-0.3, 0.3, -1.9)] * 200
    sent = np.array(ramped(commands))
    changes = np.diff(sent, axis=0)
    steps = np.linalg.norm(changes[:, :2], axis=1)
    step, yaw_step = (ACCELERATION_MARGIN * PERIOD * limit for limit in (0.3, 2.0))
    assert steps.max() <= step + 1e-12
    assert np.abs(changes[:, 2]).max() <= yaw_step + 1e-12
    arrival = 5 + math.ceil(math.hypot(0.2, 0.1) / step)
    assert sent[arrival - 2].tolist() != list(FAST)
    assert sent[arrival].tolist() == pytest.approx(list(FAST))
    # The direction of the translation is that of the command.
    assert sent[7, 1] / sent[7, 0] == pytest.approx(-0.5)


def test_after_a_stop_or_a_gap_nothing_is_remembered():
    """A stop was sent at once; of a robot that was not commanded for long nothing is known."""
    ramp = CommandRamp(ROBOT)
    for k in range(100):
        ramp.limit(FAST, SLOW, PERIOD * k)
    ramp.reset()
    first = ramp.limit(FAST, SLOW, PERIOD * 100)
    assert math.hypot(first.v_x, first.v_y) <= 0.3 * PERIOD
    assert ramp.limit(FAST, SLOW, PERIOD * 100 + 2.0 * MAX_GAP) == FAST
