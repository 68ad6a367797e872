"""The contact on the object: where it is, how it rolls and slides, and where a plan starts."""

import dataclasses
import math

from helpers.contact_sites import arc_trajectory, FACE, ROUND, SITES, VERTEX
from helpers.objects import bin_, box
from push_control.steered.estimation.contact_site import initial_contact_site
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
import pytest

POSE, PHI = Pose(1.0, -2.0, 2.5), 3.3
ROBOT = RoundRobot(radius=0.17)
NOMINAL = box(foot=0.18)


@pytest.mark.parametrize('kind', sorted(SITES))
def test_a_robot_that_has_rolled_has_no_offset(kind):
    """And one that stands off along the normal, or beside it, is so far off."""
    site = SITES[kind]
    center = site.robot_center(POSE, PHI)
    gamma = POSE.theta + site.contact_at(PHI - POSE.theta)[2]
    assert site.offset(POSE, PHI, center) == pytest.approx((0.0, 0.0), abs=1e-12)
    moved = Pose(*center, gamma).transform((-0.02, 0.005))
    assert site.offset(POSE, PHI, moved) == pytest.approx((0.02, 0.005), abs=1e-12)


@pytest.mark.parametrize('kind', sorted(SITES))
def test_a_contact_that_slides_takes_the_robot_along_and_stays_a_contact(kind):
    """The robot moves along t by what it slid; slides add up, and nothing else changes."""
    site, small = SITES[kind], 1e-4
    found = site.offset(POSE, PHI, site.after_slip(small).robot_center(POSE, PHI))
    assert found == pytest.approx((0.0, small), abs=1e-7)
    far = site.after_slip(0.03).after_slip(-0.05)
    once = site.after_slip(-0.02)
    assert far.robot_center(POSE, PHI) == pytest.approx(once.robot_center(POSE, PHI))
    c_x, c_y, _ = far.contact_at(PHI - POSE.theta)
    reach = math.dist(far.robot_center(POSE, PHI), POSE.transform((c_x, c_y)))
    assert reach == pytest.approx(site.robot_radius)
    if kind == 'vertex':
        assert (c_x, c_y) == site.point
    if kind == 'round':
        assert math.hypot(c_x, c_y) == pytest.approx(site.object_radius)


def test_the_site_of_a_trajectory():
    """Vertex, face and disc are told apart; a robot that does not touch is refused."""
    trajectory = arc_trajectory(NOMINAL, VERTEX, 0.5, 1.0)
    site = initial_contact_site(NOMINAL, ROBOT, trajectory)
    assert site.kind == 'vertex' and site.point == VERTEX.point
    assert site.normal == pytest.approx(VERTEX.normal)
    assert site.heading_offset == pytest.approx(0.0, abs=1e-9)
    face = initial_contact_site(NOMINAL, ROBOT, arc_trajectory(NOMINAL, FACE, 0.5, 1.0))
    assert face.kind == 'face' and face.point == pytest.approx(FACE.point)
    assert face.heading_offset == pytest.approx(-0.1)
    disc = initial_contact_site(bin_(), ROBOT, arc_trajectory(bin_(), ROUND, 0.5, 1.0))
    assert disc.kind == 'round' and disc.point == pytest.approx(ROUND.point)
    away = dataclasses.replace(trajectory, robot_poses=trajectory.robot_poses - (0.05, 0.05, 0.0))
    with pytest.raises(ValueError, match='robot_poses'):
        initial_contact_site(NOMINAL, ROBOT, away)
