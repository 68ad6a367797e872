"""The guard of the safety layer: every command goes one way, in one order."""

import math

import numpy as np
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_safety.layer import SafetyLayer
from push_safety.status import SafetyReason
from push_safety.tolerances import MAX_RESPONSE_TIME
import pytest

PERIOD = 0.02
ROBOT = RoundRobot(radius=0.17, max_speed=0.4, max_acceleration=0.8)
BOX = PushedObject(mass=5.0, supports=(Support(0.0, 0.0, 0.3),),
                   outline=((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)))
OBJECT = Pose(1.0, 0.0, 0.0)
STANDS = Odometry(0.0, Pose(0.0, 0.0, 0.0), STOP)
FORWARD = Twist(0.1, 0.0, 0.0)
STOOD = SafetyReason.BASE_STOOD.report(duration=5.0)
OTHERS = SafetyReason.COMMANDED_BY_OTHERS.report(others='/joystick')


class Controller:
    """Commands the same always, and notes in order what it is told and asked."""

    def __init__(self, command=FORWARD, *, awaits_resume=False, backs_off=False):
        self.command = command
        self.awaits_resume = awaits_resume
        self.backs_off = backs_off
        self.calls = []

    def on_safety_report(self, fault, stop):
        """Note why the robot stands."""
        self.calls.append(('told', fault, stop))

    def step(self, believed):
        """Note what the decision rests on."""
        self.calls.append(('asked', believed))
        return self.command


def observation(time, *, heading=0.0):
    """Measure a robot that stands before its object."""
    return Observation(time, STANDS._replace(time=time),
                       ObjectPose(time, OBJECT._replace(theta=heading)))


def guard(layer, controller, measured, **states):
    """Let a controller answer a measurement."""
    return layer.guard(measured, controller, controller.step, **states)


def test_the_controller_is_told_of_a_fault_before_it_decides_on_that_measurement():
    """And a command that was decided on nevertheless does not pass."""
    layer, controller = SafetyLayer(ROBOT, BOX), Controller()
    guard(layer, controller, observation(0.0))
    jumped = observation(PERIOD)
    jumped = jumped._replace(odometry=jumped.odometry._replace(pose=Pose(3.0, 0.0, 0.0)))
    controller.calls.clear()
    sent = guard(layer, controller, jumped)
    (told, fault, stop), (asked, believed) = controller.calls
    assert (told, asked) == ('told', 'asked')
    assert fault is not None and fault.code is SafetyReason.ODOMETRY_JUMPED and stop is fault
    assert believed.odometry is jumped.odometry and sent == STOP


def test_the_controller_decides_on_what_is_believed():
    """A heading that flips by a quarter turn of a square is taken back."""
    layer, controller = SafetyLayer(ROBOT, BOX), Controller()
    for i in range(5):
        guard(layer, controller, observation(i * PERIOD))
    guard(layer, controller, observation(5 * PERIOD, heading=0.5 * math.pi))
    _, believed = controller.calls[-1]
    assert believed.object_pose.pose.theta == pytest.approx(0.0)


@pytest.mark.parametrize('command', [Twist(math.nan, 0.0, 0.0), Twist(3.0, 0.2, 0.0)])
def test_what_is_sent_was_checked(command):
    """Finite, within the limits, and not sideways with a differential drive."""
    sent = guard(SafetyLayer(ROBOT, BOX), Controller(command), observation(0.0))
    assert math.hypot(sent.v_x, sent.v_y) <= ROBOT.max_speed and sent.v_y == 0.0


@pytest.mark.parametrize('awaits_resume', [False, True])
def test_a_base_that_stood_waits_as_long_as_its_controller_does(awaits_resume):
    """The layer is let go on before the measurement is answered."""
    layer, controller = SafetyLayer(ROBOT, BOX), Controller(awaits_resume=awaits_resume)
    guard(layer, controller, observation(0.0))
    layer.stop(STOOD)
    sent = guard(layer, controller, observation(PERIOD))
    assert controller.calls[-2] == ('told', None, STOOD if awaits_resume else None)
    assert sent == (STOP if awaits_resume else FORWARD)


def held_up(layer: SafetyLayer, controller: Controller, start: float,
            duration: float) -> list[Twist]:
    """Let a base stand, whatever it is commanded; return what was sent."""
    times = np.arange(start, start + duration, PERIOD).tolist()
    return [guard(layer, controller, observation(time)) for time in times]


def test_a_robot_that_backs_off_from_what_stopped_it_goes_on_at_once() -> None:
    """It has the time that a base takes to respond; one that does not move then is stopped."""
    layer, controller = SafetyLayer(ROBOT, BOX), Controller(Twist(0.3, 0.0, 0.0))
    assert STOP in held_up(layer, controller, 0.0, 1.0)
    controller.backs_off, controller.command = True, Twist(-0.1, 0.0, 0.0)
    assert guard(layer, controller, observation(1.0)) != STOP
    controller.backs_off = False
    assert STOP not in held_up(layer, controller, 1.0 + PERIOD, MAX_RESPONSE_TIME)
    assert STOP in held_up(layer, controller, 1.0 + MAX_RESPONSE_TIME, 1.0)


def test_interference_stops_a_robot_that_is_commanded():
    """Also one that is let go on with the same measurement."""
    layer, controller = SafetyLayer(ROBOT, BOX), Controller()
    guard(layer, controller, observation(0.0))
    layer.stop(STOOD)
    assert guard(layer, controller, observation(PERIOD), interference=OTHERS) == STOP
    assert controller.calls[-2] == ('told', None, OTHERS)


def test_a_robot_that_is_not_commanded_is_released():
    """Others may drive it: there is no reason to stop then."""
    layer, controller = SafetyLayer(ROBOT, BOX), Controller(STOP)
    guard(layer, controller, observation(0.0))
    layer.stop(OTHERS)
    guard(layer, controller, observation(PERIOD), is_commanding=False, interference=OTHERS)
    assert controller.calls[-2] == ('told', None, None)


@pytest.mark.parametrize('has_jumped', [False, True])
def test_an_object_is_expected_elsewhere_with_a_robot_that_was_put_elsewhere(
        has_jumped: bool) -> None:
    """As by a simulator that is reset; else its pose has to be confirmed."""
    layer, controller = SafetyLayer(ROBOT, BOX), Controller(STOP)
    for i in range(5):
        guard(layer, controller, observation(i * PERIOD))
    robot = Pose(3.0 if has_jumped else 0.0, 0.0, 0.0)
    for i in (5, 6):
        time = i * PERIOD
        elsewhere = OBJECT if i == 5 else Pose(2.0, 1.0, 0.0)
        guard(layer, controller, Observation(time, Odometry(time, robot, STOP),
                                             ObjectPose(time, elsewhere)))
    _, believed = controller.calls[-1]
    assert believed.object_pose.pose == (elsewhere if has_jumped else OBJECT)
    assert (believed.pose_rejection is None) == has_jumped
