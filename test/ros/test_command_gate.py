"""The robot among other commanders, without a network: whose commands count, and for how long."""

from collections import deque
from collections.abc import Callable
import logging
from types import SimpleNamespace
from typing import Any

from geometry_msgs.msg import Twist as TwistMessage
from push_control.ros import other_commanders
from push_control.ros.command_gate import CommandGate
from push_control.ros.other_commanders import OtherCommanders
from push_control.settings import ControlSettings
from push_model.events import codes
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.signals import Odometry, STOP, Twist
from push_safety.status import SafetyReason
from push_scenario.definition.loader import load_scenario
import pytest

SCENARIO = load_scenario('straight_push')
PERIOD = 0.02
OTHER = '/navigation'


class Pursuit:
    """A pursuit that drives ahead while it has a goal."""

    awaits_resume = backs_off = False

    def __init__(self) -> None:
        self.is_commanding = False
        self.stop_reasons: list[Any] = []

    def on_safety_report(self, _: Any, stop: Any) -> None:
        """Note why the robot is stopped."""
        if stop is not None:
            self.stop_reasons += codes(stop)

    def step(self, _: Observation, __: float) -> Twist:
        """Drive."""
        return Twist(0.02, 0.0, 0.0) if self.is_commanding else STOP


class Stage:
    """A gate whose robot does not have stamps on commands, and somebody else who commands it."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now, self.pursuit = 100.0, Pursuit()
        self.queue: deque[TwistMessage] = deque(maxlen=50)
        monkeypatch.setattr(other_commanders, 'time', SimpleNamespace(monotonic=lambda: self.now))
        monkeypatch.setattr(other_commanders, 'take_message',
                            lambda _: self.queue.popleft() if self.queue else None)
        node: Any = SimpleNamespace(
            create_timer=lambda _, look, **__: look(), guarded=lambda callback: callback,
            background=None, create_subscription=lambda *_, **__: 'cmd_vel',
            publishers_of=lambda _: [OTHER], count_publishers=lambda _: 1,
            get_fully_qualified_name=lambda: '/controller',
            get_logger=lambda: logging.getLogger('gate'),
            get_parameter=lambda _: SimpleNamespace(value=False))
        self.others = OtherCommanders(node, stamped=False)
        parameters: Any = SimpleNamespace(
            supervision=SimpleNamespace(odometry_reference='drifting'), robot=SCENARIO.robot,
            object=SCENARIO.object, control=ControlSettings(),
            options=SimpleNamespace(base_file='', lockstep=True, watchdog_timeout=0.25))
        self.gate = CommandGate(node, parameters, self.others)

    def send(self, command: Twist, *, is_own: bool = False) -> None:
        """Let somebody command the base; what this node sends comes back to it."""
        if is_own:
            self.others.add_own(command, 0)
        message = TwistMessage()
        message.linear.x, message.linear.y, message.angular.z = command
        self.queue.append(message)

    def measure(self, duration: float, during: Callable[[], None] = lambda: None) -> None:
        """Let odometry of a robot that stands come for a while, with what is done before each."""
        pursuit: Any = self.pursuit
        for _ in range(round(duration / PERIOD)):
            self.now += PERIOD
            during()
            odometry = Odometry(self.now, Pose(0.0, 0.0, 0.0), STOP)
            self.gate.guard(pursuit, Observation(self.now, odometry, None), PERIOD)


@pytest.fixture
def stage(monkeypatch: pytest.MonkeyPatch) -> Stage:
    """Make the gate."""
    return Stage(monkeypatch)


def test_who_has_driven_and_is_silent_does_not_stop_a_goal(stage: Stage) -> None:
    """What waits since before the goal counts from when it came."""
    stage.measure(1.0, lambda: stage.send(Twist(0.3, 0.0, 0.0)))
    stage.measure(1.0)
    stage.pursuit.is_commanding = True
    stage.measure(0.2)
    assert not stage.gate.yields and not stage.pursuit.stop_reasons


def test_who_drives_until_a_goal_comes_is_yielded_to(stage: Stage) -> None:
    """The robot begins once that one has been silent for a while."""
    stage.measure(1.0, lambda: stage.send(Twist(0.3, 0.0, 0.0)))
    stage.pursuit.is_commanding = True
    stage.measure(0.1)
    assert stage.gate.yields
    assert SafetyReason.COMMANDED_BY_OTHERS in stage.pursuit.stop_reasons
    stage.measure(1.0)
    assert not stage.gate.yields


def test_zeros_of_others_are_no_own_ones_of_long_ago(stage: Stage) -> None:
    """Who commands the base to stand is yielded to, though this node has sent zeros before."""
    stage.pursuit.is_commanding = True
    stage.measure(0.2, lambda: stage.send(STOP, is_own=True))
    assert not stage.pursuit.stop_reasons
    stage.pursuit.is_commanding = False
    stage.measure(1.0)
    stage.measure(0.2, lambda: stage.send(STOP))
    stage.pursuit.is_commanding = True
    stage.measure(0.1, lambda: stage.send(STOP))
    assert stage.gate.yields


def test_own_commands_that_come_back_late_are_own_ones(stage: Stage) -> None:
    """A process that was busy for longer than commands count does not stop for itself."""
    stage.pursuit.is_commanding = True
    stage.measure(0.2)
    for _ in range(20):
        stage.send(Twist(0.1, 0.0, 0.0), is_own=True)
    stage.now += 2.0
    stage.measure(0.2)
    assert not stage.gate.yields and not stage.pursuit.stop_reasons
