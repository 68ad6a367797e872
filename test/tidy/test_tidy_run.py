"""Pursuit of a goal of push_objects: what happens where measurements stay away."""

from helpers.objects import box
from push_control.task.code_text import code_names
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_ros.node_settings import NamedTopics, TidyOptions
from push_tidy.ros.tidy_run import RoomInputs, RunPorts, RunState, TidyRun
from push_tidy.tidy_supervisor import ObjectGoal, TidySupervisor
import pytest

OPTIONS = TidyOptions((NamedTopics('crate'), NamedTopics('chest')), pose_count=1,
                      measuring_timeout=5.0)


def test_a_tracker_that_never_answers_ends_the_goal() -> None:
    """The code says what did not come; nothing is sent to anybody before."""
    goals = {name: ObjectGoal(name, box(), Pose(1.0, 0.0, 0.0)) for name in ('crate', 'chest')}
    inputs, changes = RoomInputs(), []
    inputs.on_odometry(Pose(0.0, 0.0, 0.0))
    supervisor = TidySupervisor(list(goals.values()), RoundRobot(0.17))
    # No port is used before all is measured.
    ports = RunPorts(None, 'odom', None, None, lambda: changes.append(run.state))
    run = TidyRun(goals, supervisor, inputs, ports, options=OPTIONS, start=0.0)
    run.on_pose('crate', Pose(0.0, 0.0, 0.0), 1.0)
    for time in (100.0, 104.9, 105.1):
        assert run.state is RunState.MEASURING
        run.check(time)
    assert run.state is RunState.ENDED and changes == [RunState.ENDED]
    for failure in supervisor.failures().values():
        assert code_names(failure.codes) == ['ObjectFailure.NOT_MOVED',
                                             'ObjectFailure.NOT_MEASURED']
        assert 'room_map and poses of chest' in str(failure)


def test_odometry_goes_on_from_where_the_controller_has_the_robot() -> None:
    """What it has drifted before is taken off."""
    drift, inputs = Pose(0.4, -0.2, 0.3), RoomInputs()
    inputs.on_odometry(drift @ Pose(1.0, 0.0, 0.0))
    inputs.on_estimate(Pose(1.0, 0.0, 0.0))
    inputs.on_odometry(drift @ Pose(2.0, 1.0, 0.5))
    assert inputs.robot_pose == pytest.approx(Pose(2.0, 1.0, 0.5))
