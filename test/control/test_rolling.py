"""Laws of the contact that a free base rolls to where its normal runs through the centre."""

import dataclasses
import math

from helpers.objects import bin_, box
from helpers.push_case import GOOD_HEADING, GOOD_POSITION, held_case, run
import numpy as np
from push_control.estimation.contact_site import ContactSite
from push_control.laws.contact_steering import centering_rotation
from push_control.laws.curvature_limits import vertex_limits
from push_control.laws.limit_surface_table import LimitSurfaceTable
from push_control.observation import Observation
from push_control.push.status import Phase
from push_control.push.tracking import PushTracker
from push_control.settings import ControlSettings
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.quasi_static import vehicle
from push_model.signals import ObjectPose, Odometry, Twist
import pytest

ALLOWED = 0.1
SITES = {
    'vertex': ContactSite('vertex', 0.0, 0.17, 0.0, (-0.2, -0.2), 0.8, 0.6, (0.0, math.pi / 2)),
    'face': ContactSite('face', 1.0, 0.17, math.inf, (-0.2, 0.03), 0.0, 0.1, (-math.inf, math.inf),
                        (-0.2, 0.2)),
    'round': ContactSite('round', 0.2 / 0.37, 0.17, 0.2, (-0.2, 0.0), 0.0, 0.1, (-math.inf, math.inf))}
CENTERS = [(0.0, 0.0), (0.03, 0.08), (-0.05, -0.09), (0.08, -0.02), (-0.09, 0.01)]


def zeta(site, turn, center):
    """Angle from C->F to the normal after a turn of the robot."""
    c_x, c_y, normal = site.at(site.heading + turn)
    return math.remainder(normal - math.atan2(center[1] - c_y, center[0] - c_x), 2.0 * math.pi)


@pytest.mark.parametrize('center', CENTERS)
@pytest.mark.parametrize('kind', ['vertex', 'face'])
def test_the_normal_runs_through_the_centre(kind, center):
    """A vertex and a face can be centred exactly, within their ends."""
    site = SITES[kind]
    turn = centering_rotation(site, center, ALLOWED, 0.0)
    assert zeta(site, turn, center) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize('start', np.linspace(-3.0, 3.0, 13))
@pytest.mark.parametrize('center', CENTERS)
def test_a_disc_is_rolled_no_further_than_it_must(center, start):
    """Where the normal is near enough nothing turns, else it comes to the allowed angle."""
    point = (-0.2 * math.cos(start), -0.2 * math.sin(start))
    site = SITES['round']._replace(normal=start, point=point)
    turn, before = centering_rotation(site, center, ALLOWED, 0.0), abs(zeta(site, 0.0, center))
    after = abs(zeta(site, turn, center))
    assert (turn == 0.0) == (before <= ALLOWED)
    assert after == pytest.approx(min(before, ALLOWED), abs=1e-9)
    small = math.copysign(1e-4, turn)
    assert turn == 0.0 or abs(zeta(site, turn - small, center)) > ALLOWED


@pytest.mark.parametrize('kind', ['vertex', 'face'])
def test_the_contact_stays_on_its_feature(kind):
    """However far aside the centre, it does not roll beyond the end."""
    for center in ((1.0, -3.0), (-0.1, 3.0)):
        site = SITES[kind]
        x, y, normal = site.at(site.heading + centering_rotation(site, center, ALLOWED, 0.0))
        low, high = site.normal_limits
        aside = y * math.cos(site.normal) - x * math.sin(site.normal)
        assert low < normal < high
        assert kind == 'vertex' or site.edges[0] < aside < site.edges[1]


def test_a_steady_turn_at_the_limit_keeps_the_normal_on_the_vertex():
    """The normal of a differential drive rests at D - (L + R_p) kappa."""
    flat, room, heading_offset = vehicle(box(), (-0.2, -0.2)), (-0.5, 0.3), 0.1
    limits = vertex_limits(flat, 0.17, heading_offset, room)
    assert limits.low < 0.0 < limits.high
    for curvature in limits:
        rest = heading_offset - (flat.wheelbase + 0.17) * curvature
        assert room[0] < rest < room[1] and min(rest - room[0], room[1] - rest) < 0.03


def spun(site, speed, spin, duration=3.0, step=0.01):
    """
    Push at a speed through the centre, which does not turn the object, and spin meanwhile.

    Yields observations of the object at rest at first in the origin, and of the robot.
    """
    x = y = 0.0
    for k in range(round(duration / step) + 1):
        phi = site.heading + spin * k * step
        c_x, c_y, normal = site.at(phi)
        share = speed / math.hypot(c_x, c_y)
        v_x = -share * c_x + spin * site.robot_radius * math.sin(normal)
        v_y = -share * c_y - spin * site.robot_radius * math.cos(normal)
        pose = Pose(x, y, 0.0)
        robot = Pose(*site.robot_center(pose, phi), phi)
        twist = Twist(*robot.inverse().rotate((v_x, v_y)), spin)
        time = k * step
        yield Observation(time, Odometry(time, robot, twist), ObjectPose(time, pose))
        x, y = x - step * share * c_x, y - step * share * c_y


@pytest.mark.parametrize('spin', [-0.4, 0.0, 0.4])
@pytest.mark.parametrize('kind', ['vertex', 'face', 'round'])
def test_the_way_counted_is_that_of_the_contact(kind, spin):
    """However far a free base spins meanwhile, and so rolls its contact."""
    site, obj = SITES[kind], bin_() if kind == 'round' else box()
    observations = spun(site, 0.1, spin)
    tracking = PushTracker(RoundRobot(radius=0.17, drive='holonomic'), site,
                           LimitSurfaceTable(obj, site.point), ControlSettings(), (0.0, 0.0),
                           next(observations))
    for observation in observations:
        assert not tracking.observe(observation)
    assert tracking.way == pytest.approx(0.1 * 3.0, rel=0.01)


@pytest.mark.parametrize('kind', ['face', 'vertex', 'round'])
def test_uneven_supports_are_pushed_from_where_their_centre_is(kind):
    """The centre lies further aside than the cone reaches from where the push begins."""
    case = held_case(3, kind)
    feet = tuple(dataclasses.replace(foot, friction_coefficient=0.4 * (1.8 if foot.y < 0 else 0.6))
                 for foot in case.believed.supports)
    case = case._replace(true=dataclasses.replace(case.true, supports=feet))
    outcome = run(case, ControlSettings(), 3)
    assert outcome.status.phase is Phase.DONE, outcome.status
    assert outcome.position_error < GOOD_POSITION and outcome.heading_error < GOOD_HEADING
