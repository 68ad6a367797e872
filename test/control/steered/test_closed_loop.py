"""The steps of a push with feedback, as values: estimate, limits, command and status."""

import dataclasses
import math

from helpers.contact_sites import arc_trajectory, FACE, VERTEX
from helpers.objects import box
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.closed_loop import ARRIVAL_TIME_LIMIT, ClosedLoopPush
from push_control.steered.contact_model import ContactModel
from push_control.steered.estimation.contact_site import initial_contact_site, SITE_SIZE
from push_control.steered.estimation.filter_kernel import (
    C_SQUARED, LAST, LATEST, MEMORY_SIZE, WALK)
from push_control.steered.estimation.push_motion import MotionState
from push_control.steered.laws.closed_form import ClosedFormLaw
from push_control.steered.monitors import jackknife_fault, STEERABLE
from push_control.steered.path.guidance import Guidance
from push_control.steered.path.path import SampledPath
from push_control.steered.plan_bounds import DEVIATION_RATIO
from push_control.steered.status import Phase
from push_model.events import PushEvent
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.quasi_static import vehicle
from push_model.robot_kinematics import contact_velocity
from push_model.signals import ObjectPose, Odometry, STOP
import pytest

SETTINGS = ControlSettings()
OBJECT = box(foot=0.18)
ROBOTS = {'differential': (RoundRobot(radius=0.17), VERTEX),
          'holonomic': (RoundRobot(radius=0.17, drive='holonomic'), FACE)}
CURVATURE = 0.3


def make_model(drive, log_c_squared=0.0, offset=0.0, shift=0.0, obj=OBJECT):
    """Model a contact, and look at a push along an arc in its middle."""
    robot, site = ROBOTS[drive]
    target = arc_trajectory(obj, site, CURVATURE, 1.0)
    model = ContactModel(obj, robot, SETTINGS, target)
    model.aim(Pose(*target.object_poses[-1].tolist()))
    x, y, theta = target.object_poses[20].tolist()
    state = MotionState(x, y, theta, target.robot_poses[20, 2] + offset,
                        model.center[0] + shift * model.nominal.arm, model.center[1],
                        log_c_squared)
    memory = np.zeros(MEMORY_SIZE)
    memory[:SITE_SIZE] = initial_contact_site(obj, robot, target).values
    memory[C_SQUARED:LAST] = model.motion.supports.values
    memory[LATEST:WALK] = state
    # A robot that stands: the object is one drive lag ahead where it is now.
    model.look(memory, 0.0, make_guidance(model, target))
    return model


def make_guidance(model, target):
    """Follow a planned path."""
    return Guidance(SampledPath(model.nominal, target), SETTINGS)


@pytest.mark.parametrize('drive', sorted(ROBOTS))
def test_an_object_on_its_planned_path_has_its_flat_output_there(drive):
    """In the goal frame, the rest of the arc before the origin."""
    model = make_model(drive)
    left = 19.0 / 39.0
    for z in (model.flat_output, model.flat_output_now):
        assert z.theta == pytest.approx(-CURVATURE * left, abs=1e-9)
        assert (z.x, z.y) == pytest.approx((-math.sin(CURVATURE * left) / CURVATURE,
                                            (1.0 - math.cos(CURVATURE * left)) / CURVATURE),
                                           abs=1e-9)


@pytest.mark.parametrize('heights', [{}, {'contact_height': 0.1, 'center_of_mass_height': 0.1}])
@pytest.mark.parametrize('drive', sorted(ROBOTS))
def test_the_estimated_supports_move_the_flat_output(drive, heights):
    """With twice the c^2, z is twice as far ahead of the centre of friction."""
    obj = dataclasses.replace(OBJECT, **heights)
    model = make_model(drive, math.log(2.0), obj=obj)
    contact = model.vehicle.contact_point
    plain = vehicle(obj, contact, model.center)
    assert model.vehicle[:3] == pytest.approx((plain.arm, 2.0 * plain.c_squared, plain.angle))
    for axis in (0, 1):
        assert (model.vehicle.flat_output[axis] - model.center[axis] == pytest.approx(
            2.0 * (plain.flat_output[axis] - model.center[axis])))
    assert model.center_error_ratio() == 0.0
    assert make_model(drive, shift=0.1).center_error_ratio() == pytest.approx(0.1)


@pytest.mark.parametrize('drive', sorted(ROBOTS))
def test_limits_widen_with_the_fraction_of_the_cone(drive):
    """Both ways, around a straight push; none of the cone allows one curvature only."""
    model = make_model(drive)
    none, half, whole = (model.limits(fraction) for fraction in (0.0, 0.5, 1.0))
    assert none.low == pytest.approx(none.high, abs=1e-9)
    assert whole.low < half.low < none.low and none.high < half.high < whole.high
    feedback = model.limits(SETTINGS.feedback_cone_fraction)
    assert model.limits_now == feedback


@pytest.mark.parametrize('drive', sorted(ROBOTS))
@pytest.mark.parametrize('curvature', [-0.2, 0.0, 0.2])
def test_the_command_pushes_in_the_direction_that_gives_the_curvature(drive, curvature):
    """At the speed asked for, by the quasi-static model of the estimator."""
    model = make_model(drive)
    command, mode = model.command(curvature, 0.05)
    assert mode == STEERABLE
    state = model.predicted
    gamma = state.theta + model.motion.site.contact_at(state.relative_heading).normal
    velocity = contact_velocity(state.phi, gamma, 0.17, command)
    assert math.hypot(*velocity) == pytest.approx(0.05)
    rates = model.motion.rates(state, command)
    along = state.theta + model.vehicle.angle
    speed = velocity[0] * math.cos(along) + velocity[1] * math.sin(along)
    assert rates.omega / speed == pytest.approx(curvature, abs=0.01)


@pytest.mark.parametrize('drive', sorted(ROBOTS))
def test_a_gap_is_closed_along_the_normal(drive):
    """By a base that can move so; else ahead, and never turning."""
    command, site = make_model(drive).approach(), ROBOTS[drive][1]
    direction = 0.0 if drive == 'differential' else site.heading_offset
    assert command.omega == 0.0 and (command.v_x, command.v_y) == pytest.approx(
        (SETTINGS.start_speed * math.cos(direction), SETTINGS.start_speed * math.sin(direction)))


def test_a_contact_that_has_folded_up_gets_no_command():
    """The robot has turned round the vertex."""
    command, mode = make_model('differential', offset=1.2).command(0.0, 0.05)
    assert command == STOP and jackknife_fault(mode) is not None


def test_nothing_steers_at_the_centre_of_friction():
    """A contact that is there is refused."""
    model = make_model('differential')
    _, site = ROBOTS['differential']
    guidance = make_guidance(model, arc_trajectory(OBJECT, site, CURVATURE, 1.0))
    model.memory[LATEST + 4:LATEST + 6] = model.vehicle.contact_point
    with pytest.raises(ValueError, match='the point of contact'):
        model.look(model.memory, 0.0, guidance)
    model.memory[LATEST] = math.nan
    with pytest.raises(ValueError, match='expected finite numbers'):
        model.look(model.memory, 0.0, guidance)


def test_a_push_that_begins_has_everything_before_it():
    """Errors are those of the whole plan, nothing is lost, and no plan is requested."""
    robot, site = ROBOTS['differential']
    target = arc_trajectory(OBJECT, site, CURVATURE, 1.0)
    target = dataclasses.replace(target, contact_twists=np.full((40, 3), 0.1))
    poses = Pose(*target.object_poses[0].tolist()), Pose(*target.robot_poses[0].tolist())
    first = Observation(0.0, Odometry(0.0, poses[1], STOP), ObjectPose(0.0, poses[0]))
    push = ClosedLoopPush(OBJECT, robot, SETTINGS, ClosedFormLaw(SETTINGS), target, first)
    status = push.status(Phase.PUSHING, None)
    assert status.remaining_distance == pytest.approx(1.0, abs=1e-3)
    assert status.position_error == pytest.approx(
        math.dist(target.object_poses[0, :2], target.object_poses[-1, :2]))
    assert status.robot_pose == pytest.approx(poses[1], abs=1e-9)
    assert status.in_contact and not status.replan_requested and not push.finished
    assert push.failure is None and push.notice is None
    assert push.advance(0.0, 0.0).v_x > 0.0
    assert push.status(Phase.PUSHING, None).remaining_distance == pytest.approx(1.0, abs=5e-3)


@pytest.mark.parametrize('limit, fails', [(0.0, True), (4.0, False)])
def test_a_push_whose_object_has_left_the_floor_of_its_plan_has_failed(limit, fails):
    """By some sizes of the object, where nothing else is set; no plan leads back."""
    robot, site = ROBOTS['differential']
    target = arc_trajectory(OBJECT, site, 0.01, 3.0)
    start = Pose(*target.object_poses[0].tolist())
    limit_by_size = DEVIATION_RATIO * OBJECT.size
    aside = 1.1 * limit_by_size
    place = Pose(start.x, start.y + aside, start.theta)
    center = place @ (start.inverse() @ Pose(*target.robot_poses[0].tolist()))
    settings = dataclasses.replace(SETTINGS, max_path_deviation=limit)
    push = ClosedLoopPush(OBJECT, robot, settings, ClosedFormLaw(settings), target,
                          Observation(0.0, Odometry(0.0, center, STOP), ObjectPose(0.0, place)))
    push.advance(0.02, 0.02)
    assert (push.failure is not None) is fails and not push.replan_requested
    # By how much the goal is missed.
    missed = f'{1e3 * math.dist(place[:2], target.object_poses[-1, :2]):.0f} mm and 1.7 deg away'
    assert not fails or f'{limit_by_size:.2f} m; the goal is {missed}' in str(push.failure)


@pytest.mark.parametrize('drive', sorted(ROBOTS))
@pytest.mark.parametrize('beyond_limit, first, last', [
    (-0.5, 'done', 'done'), (-0.05, 'open', 'done'), (-0.005, 'open', 'missed'),
    (0.05, 'missed', 'missed')])
def test_an_object_counts_as_at_its_goal_once_its_deviation_fits_into_the_tolerance(
        drive: str, beyond_limit: float, first: str, last: str) -> None:
    """Near the limit further poses decide; where they leave it open, the push is not done."""
    robot, site = ROBOTS[drive]
    settings = dataclasses.replace(SETTINGS, max_reapproaches=0)
    target = arc_trajectory(OBJECT, site, CURVATURE, 1.0)
    end, error = target.object_poses[-1], (1.0 + beyond_limit) * settings.position_tolerance
    ahead = end[:2] - target.object_poses[-2, :2]
    ahead *= error / np.hypot(*ahead)
    pose = Pose(end[0] + ahead[0], end[1] + ahead[1], end[2])
    x, y, heading = target.robot_poses[-1].tolist()
    robot_pose = Pose(x + ahead[0], y + ahead[1], heading)

    def measured(time: float) -> Observation:
        return Observation(time, Odometry(time, robot_pose, STOP), ObjectPose(time, pose))

    push = ClosedLoopPush(OBJECT, robot, settings, ClosedFormLaw(settings), target, measured(0.0))
    states = []
    for index in range(1, round(ARRIVAL_TIME_LIMIT / 0.05) + 6):
        push.observe(measured(0.05 * index))
        assert push.advance(0.05 * index, 0.05) == STOP
        states.append('done' if push.finished else
                      'open' if push.failure is None else 'missed')
        if push.failure is not None:
            is_doubted = push.failure.code is PushEvent.ARRIVAL_UNCERTAIN
            assert is_doubted or push.failure.code is PushEvent.GOAL_MISSED
            assert is_doubted == (first == 'open') and is_doubted != push.replan_requested
            break
    # Two steps see that the path is at its end, the third that the robot is at rest.
    assert states[:3][-1] == first and states[-1] == last
