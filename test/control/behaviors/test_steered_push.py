"""What a push tells of the robot's place and of the friction centre, on the simulated plant."""

import functools
import math
from typing import NamedTuple

from helpers.objects import bin_, box
from helpers.push_problems import (
    DIFFERENTIAL, face_problem, HOLONOMIC, round_problem, vertex_problem)
import numpy as np
from push_control.behaviors.failures import BehaviorFailure
from push_control.behaviors.progress import ProgressMonitor
from push_control.behaviors.steered_push import FAILED_PUSH_STD
from push_control.perception.ensemble.members import ODOMETRY_ERRORS
from push_control.perception.perception import TaskPerception
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_control.task.repeated_pushes import RepeatedPushBehaviors
from push_control.task.status import TaskState
from push_model.friction import friction_center
from push_model.geometry import Pose, wrap_angle
from push_model.observation import Observation
from push_model.signals import Odometry, STOP
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_planner.steered.planner import plan_push
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation, SimulationSettings
import pytest

# Plans and simulated pushes take some seconds each.
pytestmark = pytest.mark.slow

NEARS_OBSTACLE = BehaviorFailure.OBJECT_NEARS_OBSTACLE, BehaviorFailure.ROBOT_NEARS_OBSTACLE
CONTROL = ControlSettings()
PROGRESS = ProgressMonitor(SupervisionSettings(), (0.01, 0.02))
HOME, AHEAD, TURNED = Pose(0.0, 0.0, 0.0), Pose(1.2, 0.0, 0.0), math.radians(3.0)
# Spread of the friction of supports over that of an object about which nothing is known: as for a
# friction centre that is known to 2 mm, and to 23 mm.
KNOWN, UNKNOWN = 0.1, 1.0
# The friction centre of this one is 29 mm off on the right of a push along x.
UNEVEN = box(friction=(0.4, 0.4, 0.3, 0.3))
EXACT = SensorSettings()
NOISY = SensorSettings(pose_noise=2e-3, pose_heading_noise=math.radians(0.3), pose_latency=0.08)


class PushOutcome(NamedTuple):
    """A push that is over; errors are what is believed less what is true [m, m, rad]."""

    behavior: object
    error: tuple
    standard_deviations: tuple
    center: np.ndarray
    object_pose: Pose


@functools.lru_cache
def planned(kind, world):
    """Plan a push straight ahead, along the x axis of ``world``."""
    if kind == 'vertex':
        aslant = Pose(0.0, 0.0, -math.pi / 4)
        return plan_push(vertex_problem(world @ AHEAD @ aslant, start=world @ aslant)).trajectory
    problem = {'face': face_problem, 'round': round_problem}[kind]
    return plan_push(problem(world @ AHEAD, start=world)).trajectory


def push(kind='face', true=None, aside=0.0, turned=0.0, unsure=0.03, friction=KNOWN,
         supervision=SupervisionSettings(), sensors=EXACT, radius=0.0, world=HOME,
         occupancy_map=None):
    """
    Push with a robot that stands beside where it is believed to stand, and tell what it learns.

    :param aside: to the left of the push [m].
    :param unsure: standard deviation of where it is believed to stand [m]; of its heading as much
        as it comes to on a way of 70 of these.
    :param friction: spread of the friction of supports, ``KNOWN`` or ``UNKNOWN``.
    :param radius: of the object on which it stands aside; 0 for a straight one [m].
    """
    believed = bin_() if kind == 'round' else box()
    robot, target = (DIFFERENTIAL if kind == 'vertex' else HOLONOMIC), planned(kind, world)
    place, reach = Pose(*target.robot_poses[0].tolist()), radius + robot.radius
    nearer = reach - math.sqrt(reach ** 2 - aside ** 2) if radius else 0.0
    stands = place @ Pose(nearer, aside, turned)
    plant = Simulation(true or believed, robot, Pose(*target.object_poses[0].tolist()), stands,
                       SimulationSettings(seed=1), sensors)
    behaviors = RepeatedPushBehaviors(believed, robot, CONTROL, DriveSettings(), supervision)
    behaviors.occupancy_map = occupancy_map
    perception = TaskPerception(believed, robot, CONTROL, supervision)
    members = perception.localization.members
    members.parameters[:, ODOMETRY_ERRORS:-1] *= friction
    members.apply_parameters()
    carry = place @ stands.inverse()
    before = place @ Pose(-70.0 * unsure, 0.0, 0.0)
    perception.update(Observation(-1.0, Odometry(-1.0, before, STOP)))
    perception.localization.inflate_covariance(unsure)
    behavior, pose, time = None, None, 0.0
    while plant.time < 30.0 and not (behavior and (behavior.finished or behavior.failure)):
        measured = plant.next_measurement()
        if not isinstance(measured, Odometry):
            pose = measured
            continue
        odometry = measured._replace(pose=carry @ measured.pose)
        perception.update(Observation(plant.time, odometry, pose))
        behavior = behavior or behaviors.create(TaskState.PUSH, target, None, perception, PROGRESS)
        plant.command(behavior.step(perception, plant.time - time))
        time = plant.time
    there, is_ = perception.localization.pose, plant.truth.robot_pose
    error = there.x - is_.x, there.y - is_.y, wrap_angle(there.theta - is_.theta)
    center = np.array(perception.localization.friction_center)
    return PushOutcome(behavior, error, perception.localization.standard_deviations, center,
                       plant.truth.object_pose)


@functools.lru_cache
def push_beside(aside, turned, sensors):
    """Push at a face from beside the place where the robot is believed to stand, once."""
    return push(aside=aside, turned=turned, sensors=sensors)


def walled(y):
    """Make a floor with a wall along the x axis at some distance, and nothing behind it."""
    rows = math.copysign(0.025, y) * (np.arange(160) - 79.5) > abs(y)
    return OccupancyMap(0.025, Pose(-1.5, -2.0, 0.0), np.tile(rows[:, None], 200))


@pytest.mark.parametrize('sensors', [EXACT, NOISY], ids=['exact', 'noisy'])
@pytest.mark.parametrize('aside, turned', [(0.03, TURNED), (-0.03, TURNED), (0.03, -TURNED)])
def test_a_robot_beside_its_place_at_a_face_finds_it(aside, turned, sensors):
    """The object turns as if its friction centre, which is known, were on the other side."""
    outcome = push_beside(aside, turned, sensors)
    assert outcome.behavior.finished
    assert math.hypot(*outcome.error[:2]) < 0.25 * abs(aside)
    assert abs(outcome.error[2]) < 0.25 * abs(turned)
    assert np.all(np.abs(outcome.error) < 3.0 * outcome.standard_deviations)
    assert np.hypot(*outcome.center) < 0.2 * abs(aside)


@pytest.mark.parametrize('sensors', [EXACT, NOISY], ids=['exact', 'noisy'])
@pytest.mark.parametrize('aside', [0.03, -0.03])
def test_a_push_sees_the_offset_of_the_contact_from_the_friction_centre(aside, sensors):
    """Where neither is known both are corrected; their distance is known, across the push."""
    outcome = push(aside=aside, turned=math.copysign(TURNED, aside), sensors=sensors,
                   friction=UNKNOWN)
    assert outcome.error[1] == pytest.approx(outcome.center[1], abs=0.1 * abs(aside))
    assert np.all(np.abs(outcome.error) < 3.0 * outcome.standard_deviations)


def test_left_and_right_tell_the_same():
    """A robot as far to the other side is found as far to that side, as far as it is known."""
    left, right = push_beside(0.03, TURNED, EXACT), push_beside(-0.03, -TURNED, EXACT)
    difference = np.array(left.error) * (1.0, -1.0, -1.0) - right.error
    assert np.all(np.abs(difference) < left.standard_deviations)
    assert left.standard_deviations == pytest.approx(right.standard_deviations, rel=0.2)
    assert left.center * (1.0, -1.0) == pytest.approx(right.center, abs=2e-3)


def test_it_does_not_matter_which_way_the_push_goes():
    """With everything turned, what is identified is turned, as far as it is known."""
    world = Pose(3.0, -1.0, 2.0)
    one = push_beside(0.03, TURNED, EXACT)
    two = push(aside=0.03, turned=TURNED, world=world)
    back = Pose(0.0, 0.0, -world.theta).rotate(two.error[:2])
    assert np.all(np.abs(np.subtract((*back, two.error[2]), one.error))
                  < one.standard_deviations + 1e-4)
    assert two.center == pytest.approx(one.center, abs=2e-3)


@pytest.mark.parametrize('aside', [0.03, -0.03])
def test_a_robot_beside_its_place_at_a_round_side_finds_it(aside):
    """There the contact is off by less than the robot."""
    outcome = push('round', aside=aside, radius=0.2)
    assert outcome.behavior.finished
    assert math.hypot(*outcome.error[:2]) < 0.25 * abs(aside)


def test_one_error_is_not_counted_twice():
    """What a push sees goes to the friction centre where the place is known, else to the place."""
    side = friction_center(UNEVEN)[1]
    sure = push(true=UNEVEN, unsure=0.0, friction=UNKNOWN)
    assert sure.behavior.finished and abs(side) > 0.02
    assert math.hypot(*sure.error[:2]) < 0.2 * abs(side)
    assert sure.center[1] == pytest.approx(side, rel=0.2)
    unsure = push(aside=-side)
    assert math.hypot(*unsure.error[:2]) < 0.25 * abs(side)
    assert abs(unsure.center[1]) < 0.2 * abs(side)


def test_a_push_off_its_path_tells_the_friction_centre_too():
    """As far as its centimetres go; the robot is where it was believed to be."""
    outcome = push(true=UNEVEN, unsure=0.0, friction=UNKNOWN,
                   supervision=SupervisionSettings(max_path_deviation=0.003))
    assert outcome.behavior.failure.code is BehaviorFailure.OFF_PLANNED_PATH
    assert not outcome.behavior.finished
    assert outcome.behavior.push_status.slips == outcome.behavior.push_status.contact_losses == 0
    assert 0.3 < outcome.center[1] / friction_center(UNEVEN)[1] < 1.3
    assert math.hypot(*outcome.error[:2]) < 0.01


def test_a_push_that_slips_and_fails_makes_the_place_less_sure():
    """The robot may be anywhere along the object, by centimetres."""
    outcome = push(true=box(contact_friction_coefficient=0.02, friction=(0.5, 0.5, 0.1, 0.1)),
                   aside=0.05, unsure=0.0)
    assert outcome.behavior.failure is not None and outcome.behavior.push_status.slips > 0
    # Of a hundred members, whose spread is that of their distribution within three deviations.
    assert outcome.standard_deviations[1] >= (1.0 - 3.0 / math.sqrt(200.0)) * FAILED_PUSH_STD


@pytest.mark.parametrize('friction', [(0.3, 0.3, 0.3, 0.3), (0.4, 0.4, 0.3, 0.3)])
@pytest.mark.parametrize('aside', [-0.05, 0.05])
def test_a_contact_that_slides_leaves_the_place_within_its_uncertainty(aside, friction):
    """A contact as slippery as that is two standard deviations from the nominal one."""
    true = box(contact_friction_coefficient=0.2, friction=friction)
    outcome = push(true=true, aside=aside, friction=UNKNOWN)
    assert np.all(np.abs(outcome.error) < 3.0 * outcome.standard_deviations)


@pytest.mark.parametrize('side', [1.0, -1.0])
def test_a_push_that_deviates_towards_a_wall_ends_before_it(side):
    """A wall beside the path is not touched; one far off does not matter, nor to a true push."""
    uneven = box(friction=(0.4, 0.4, 0.2, 0.2) if side < 0.0 else (0.2, 0.2, 0.4, 0.4))
    for true, wall, ends in ((uneven, 0.27, True), (uneven, 0.6, False), (box(), 0.27, False)):
        floor = walled(side * wall)
        outcome = push(true=true, occupancy_map=floor)
        assert floor.object_is_free(box(), [outcome.object_pose], 0.0)
        failure = outcome.behavior.failure
        assert (failure is not None and failure.code in NEARS_OBSTACLE) == ends
        assert outcome.behavior.finished != ends


def test_at_a_vertex_the_place_is_told_whatever_the_friction():
    """It touches where it touches; the friction centre is identified besides."""
    true = box(friction=(0.3, 0.35, 0.3, 0.25))
    one, two = (push('vertex', truth, turned=TURNED, friction=UNKNOWN) for truth in (None, true))
    assert one.behavior.finished and two.behavior.finished
    # By odometry alone it would be off by some 63 mm.
    for outcome in (one, two):
        assert math.hypot(*outcome.error[:2]) < 0.05
        assert np.all(np.abs(outcome.error) < 3.0 * outcome.standard_deviations)
    center = np.array(friction_center(true))
    outcome = push('vertex', true, friction=UNKNOWN)
    across = center / np.hypot(*center)
    assert across @ outcome.center == pytest.approx(np.hypot(*center), rel=0.3)
