"""A single push pursues the goal that was asked for, and not where its plan ends."""

from types import SimpleNamespace
from typing import Any

from helpers.maps import walled_room
from helpers.objects import box
from helpers.push_problems import face_problem, HOLONOMIC
from push_control.behaviors.behavior import BehaviorContext
from push_control.behaviors.failures import BehaviorFailure
from push_control.behaviors.single_push import SinglePush
from push_control.goal import TaskGoal
from push_control.settings import ControlSettings
from push_control.steered.controller import Controller
from push_control.supervision_settings import SupervisionSettings
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.plan_request import GoalTolerances
from push_model.signals import ObjectPose, Odometry, STOP
from push_model.trajectory import PushTrajectory
from push_navigation.settings import DriveSettings
from push_planner.steered.planner import plan_push
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation, SimulationSettings
import pytest

CONTEXT = BehaviorContext(box(), HOLONOMIC, ControlSettings(), DriveSettings(),
                          SupervisionSettings())
END = Pose(1.0, 0.0, 0.0)
# Within the tolerances of the goal, and beyond them.
NEAR, FAR = Pose(1.008, 0.0, 0.0), Pose(2.0, 0.0, 0.0)


@pytest.fixture(scope='module')
def target() -> PushTrajectory:
    """Plan a push of a metre."""
    return plan_push(face_problem(END)).trajectory


@pytest.fixture(autouse=True)
def _astray(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the controller find that the push has left its path."""
    if 'target' in request.fixturenames:
        monkeypatch.setattr(Controller, 'step', lambda *_: STOP)
        monkeypatch.setattr(Controller, 'replan_requested', True)


def requested_goal(push: SinglePush) -> Pose:
    """Return the goal of the plan that a push requests."""
    perception: Any = SimpleNamespace(observation=Observation(
        5.0, Odometry(5.0, Pose(0.1, 0.1, 0.0), STOP), ObjectPose(5.0, Pose(0.5, 0.1, 0.0))))
    push.step(perception, 0.02)
    assert push.plan_request is not None
    return push.plan_request.goal


@pytest.mark.parametrize('goal, pursued', [(NEAR, NEAR), (FAR, END), (None, END)])
def test_another_plan_leads_to_the_goal_that_was_asked_for(
        target: PushTrajectory, goal: Pose | None, pursued: Pose) -> None:
    """Else each plan would be off by a tolerance from the last; one for no goal has its end."""
    push = SinglePush(CONTEXT, target, goal)
    for _ in range(3):
        assert requested_goal(push) == pytest.approx(pursued, abs=2e-3)
        push.take_plan(target)


def test_a_plan_to_another_goal_changes_the_goal(target: PushTrajectory) -> None:
    """From when it comes."""
    push = SinglePush(CONTEXT, target, END)
    push.take_goal(TaskGoal(NEAR, 0.0), GoalTolerances())
    push.take_plan(target)
    assert requested_goal(push) == pytest.approx(NEAR, abs=1e-9)


@pytest.mark.parametrize('wall, ends', [(0.27, True), (0.8, False)])
def test_a_push_that_deviates_towards_a_wall_ends_before_it(wall: float, ends: bool) -> None:
    """The floor is rougher on one side; a wall that is far off does not matter."""
    target = plan_push(face_problem(Pose(1.2, 0.0, 0.0))).trajectory
    floor = walled_room((-3.0, 3.0, wall, wall + 0.1), resolution=0.025)
    push = SinglePush(CONTEXT._replace(occupancy_map=floor), target, None)
    plant = Simulation(box(friction=(0.2, 0.2, 0.4, 0.4)), HOLONOMIC,
                       Pose(*target.object_poses[0].tolist()),
                       Pose(*target.robot_poses[0].tolist()), SimulationSettings(seed=1),
                       SensorSettings())
    time, pose = 0.0, None
    while plant.time < 30.0 and not push.finished and push.failure is None:
        measured = plant.next_measurement()
        if not isinstance(measured, Odometry):
            pose = measured
            continue
        perception: Any = SimpleNamespace(observation=Observation(plant.time, measured, pose))
        plant.command(push.step(perception, plant.time - time))
        time = plant.time
    assert floor.object_is_free(box(), [plant.truth.object_pose], 0.0)
    nears = BehaviorFailure.OBJECT_NEARS_OBSTACLE, BehaviorFailure.ROBOT_NEARS_OBSTACLE
    assert (push.failure is not None and push.failure.code in nears) is ends
    assert push.finished is not ends


def test_a_new_wall_across_the_path_blocks_a_push(target: PushTrajectory) -> None:
    """One beside it does not, nor one that was there before."""
    push = SinglePush(CONTEXT, target, END)
    start = Pose(*target.robot_poses[0].tolist())
    across, beside = walled_room((0.7, 0.75, -0.5, 0.5)), walled_room((0.7, 0.75, 0.5, 1.0))
    assert push.is_blocked(across, start)
    assert not push.is_blocked(beside, start) and not push.is_blocked(None, start)
