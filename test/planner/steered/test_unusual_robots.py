"""Points and fences: the simulator drives them, everyone else copes or says no."""

import math

from builtin_interfaces.msg import Time
from helpers.objects import box
from helpers.tapes import straight_plan
from push_control.settings import ControlSettings
from push_control.steered.controller import Controller
from push_control.steered.status import Phase
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import Contact, RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_planner.problem import PlanningFailed, problem_from_placement
from push_planner.steered.planner import plan_push
from push_planner.steered.verification.verification import verify
from push_ros.conversions.markers import MarkerHeader, scene_markers
from push_scenario.definition.scenario import Placement, Start
from push_sim_node.simulation import Simulation
import pytest

UNUSUAL = pytest.mark.parametrize('radius', [0.0, math.inf])


def test_planner_refuses_a_fence_with_the_reason():
    robot = RoundRobot(math.inf, 'holonomic')
    with pytest.raises(PlanningFailed, match='not for flat pushers'):
        problem_from_placement(box(), robot, Pose(0.0, 0.0, 0.0), Pose(-0.2, 0.0, 0.0),
                               Pose(1.0, 0.0, 0.0))


def test_a_point_on_a_face_is_planned_for_and_at_a_vertex_refused():
    robot, here = RoundRobot(0.0, 'holonomic'), Pose(0.0, 0.0, 0.0)
    answer = plan_push(problem_from_placement(box(), robot, here, Pose(-0.2, 0.0, 0.0),
                                              Pose(1.0, 0.3, 0.4)))
    assert verify(answer).position_error < 1e-3
    with pytest.raises(PlanningFailed, match='a point robot needs .* a face or a round'):
        plan_push(problem_from_placement(box(), robot, here, Pose(-0.2, -0.2, 0.0),
                                         Pose(1.0, 0.3, 0.4)))


@UNUSUAL
def test_controller_refuses_with_the_reason(radius):
    robot, start = RoundRobot(radius, 'holonomic'), Pose(-0.2, 0.0, 0.0)
    controller = Controller(box(), robot, ControlSettings())
    seen = Observation(0.0, Odometry(0.0, start, STOP), ObjectPose(0.0, Pose(0.0, 0.0, 0.0)))
    assert controller.step(straight_plan(), seen, 0.0) == STOP
    assert controller.status.phase is Phase.FAILED
    assert 'neither a point nor a fence' in controller.status.reason


@UNUSUAL
def test_start_places_it_at_the_contact(radius):
    start = Start(object=Placement(1.0, 2.0, 0.5), contact=Contact('face', 3, 0.05), gap=0.02)
    pose = start.robot_pose(box(), radius)
    assert pose == pytest.approx(Pose(1.0, 2.0, 0.5) @ Pose(-0.22, 0.05, 0.0))
    truth = Simulation(box(), RoundRobot(radius), start.object.pose, pose).truth
    assert truth.gap == pytest.approx(0.02)


@UNUSUAL
def test_markers_have_a_finite_size(radius):
    robot, pose = RoundRobot(radius), Pose(-0.2, 0.0, 0.0)
    scene = scene_markers(MarkerHeader(Time(), 'odom', 'sim'), box(), robot,
                          Pose(0.0, 0.0, 0.0), pose)
    sizes = [size for marker in scene.markers
             for size in (marker.scale.x, marker.scale.y, marker.scale.z)]
    assert 0.5 < max(sizes) < 5.0 if radius else max(sizes) < 0.5
    assert all(marker.scale.x > 0.0 for marker in scene.markers)
