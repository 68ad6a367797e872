"""What a scan shows stops a robot whatever pushes the object: one push, or one of several."""

from push_control.settings import ControlSettings
from push_control.steered.rehearsal import rehearsal_plan
from push_control.supervision_settings import SupervisionSettings
from push_control.task.behavior_factory import BehaviorFactory
from push_control.task.repeated_pushes import RepeatedPushBehaviors
from push_control.task.single_push import SinglePushBehaviors
from push_control.task.supervisor import Supervisor
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_navigation.settings import DriveSettings
from push_safety.protective_field import ProtectiveCause
from push_safety.status import SafetyReason
import pytest

PERIOD = 0.05
OBJECT, ROBOT = (read_object('config/objects/box_04.yaml'),
                 read_robot('config/robots/disc_017.yaml'))
PLAN = rehearsal_plan(OBJECT, ROBOT)
PLACE, GOAL = Pose(*PLAN.robot_poses[0].tolist()), Pose(*PLAN.object_poses[-1].tolist())
FACTORIES = RepeatedPushBehaviors, SinglePushBehaviors
LATE = SafetyReason.FOLLOWS_LATE.report(delay=0.5)


class Run:
    """A supervisor that follows a plan, and a robot that stands at its start."""

    def __init__(self, factory: type[BehaviorFactory]) -> None:
        self.supervisor = Supervisor(OBJECT, ROBOT, ControlSettings(), DriveSettings(),
                                     SupervisionSettings(), factory=factory)
        self.time = 0.0
        self.supervisor.set_goal(GOAL)
        self.step()
        self.supervisor.drive(PLAN)

    def answer(self) -> Twist:
        """Answer the newest measurements, perhaps once more."""
        return self.supervisor.step(Observation(
            self.time, Odometry(self.time, PLACE, STOP),
            ObjectPose(self.time, Pose(*PLAN.object_poses[0].tolist()))), PERIOD)

    def step(self) -> Twist:
        """Let time pass; return the command."""
        self.time += PERIOD
        return self.answer()

    def drives(self) -> bool:
        """Tell whether the robot is commanded to move within a second."""
        return any(self.step() != STOP for _ in range(20))


@pytest.mark.parametrize('factory', FACTORIES)
@pytest.mark.parametrize('cause', ProtectiveCause)
def test_a_robot_under_way_stands_for_what_a_scan_shows(
        factory: type[BehaviorFactory], cause: ProtectiveCause) -> None:
    """From the scan on, until it is over; where a person is awaited, until they say so."""
    run, report = Run(factory), cause.report(restart_time=1.0, age=1.0)
    supervisor = run.supervisor
    assert run.drives()
    supervisor.protect(report)
    assert run.answer() == STOP and supervisor.cause is report
    assert not run.drives() and supervisor.cause is report
    supervisor.protect(None)
    if cause.awaits_resume:
        assert not run.drives() and supervisor.awaits_resume
        supervisor.resume()
    # One of several pushes is planned anew.
    assert not supervisor.awaits_resume and (run.drives() or supervisor.awaits_plan)


@pytest.mark.parametrize('factory', FACTORIES)
def test_a_stop_hides_nothing_that_a_scan_shows(factory: type[BehaviorFactory]) -> None:
    """A robot that may follow its commands again still stands for who is in its way."""
    run, report = Run(factory), ProtectiveCause.OBSTRUCTED.report(restart_time=1.0)
    run.supervisor.on_safety_report(LATE, LATE)
    run.supervisor.protect(report)
    assert not run.drives()
    run.supervisor.on_safety_report(None, None)
    assert not run.drives() and run.supervisor.cause is report


def test_a_single_push_sets_out_from_rest_after_a_hold_of_any_length() -> None:
    """It has not waited for measurements meanwhile."""
    run = Run(SinglePushBehaviors)
    speeds = [run.step().v_x for _ in range(10)]
    assert speeds[0] < speeds[-1]
    run.supervisor.protect(ProtectiveCause.NO_SCAN.report(age=1.0))
    run.step()
    run.time += 3600.0
    run.step()
    run.supervisor.protect(None)
    assert 0.0 < run.step().v_x <= speeds[1]
