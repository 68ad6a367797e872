"""Contact geometry: rolling constants, contacts found from poses, and features that are named."""

import math

from helpers.objects import bin_, box
import numpy as np
from push_model.contact import (
    contact_point, find_contact, normal_range, robot_gap, rolling_constants,
)
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import Contact
import pytest

FLAT_PUSHER = math.inf


@pytest.mark.physics
@pytest.mark.parametrize('robot, surface, expected', [
    (0.17, 0.0, (0.0, 0.0)), (0.17, math.inf, (1.0, 0.17)), (0.0, 0.3, (1.0, 0.0)),
    (math.inf, 0.3, (0.0, 0.3)), (0.2, 0.2, (0.5, 0.1)), (0.0, math.inf, (1.0, 0.0))])
def test_rolling_constants_have_their_limits(robot, surface, expected):
    assert rolling_constants(robot, surface) == pytest.approx(expected)


@pytest.mark.parametrize('robot, surface', [(0.0, 0.0), (math.inf, math.inf), (-1.0, 0.1),
                                            (0.1, math.nan)])
def test_rolling_needs_a_curved_surface(robot, surface):
    with pytest.raises(ValueError, match='radius'):
        rolling_constants(robot, surface)


@pytest.mark.parametrize('obj', [box(), bin_()])
def test_contact_found_from_geometry_is_the_contact_named(obj):
    rng = np.random.default_rng(3)
    for _ in range(200):
        pose = Pose(*rng.uniform(-2, 2, 3))
        bearing, away = rng.uniform(-math.pi, math.pi), rng.uniform(0.5, 1.0)
        point = pose.x + away * math.cos(bearing), pose.y + away * math.sin(bearing)
        contact, gamma, gap = find_contact(obj, pose, point, 0.1)
        assert robot_gap(obj, pose, point, 0.1) == gap
        x, y = pose.transform(contact_point(obj, contact))
        distance = gap + 0.1
        expected = x - distance * math.cos(gamma), y - distance * math.sin(gamma)
        assert point == pytest.approx(expected, abs=2e-3 if contact.kind == 'vertex' else 1e-9)
        low, high = normal_range(obj, contact)
        middle = 0.5 * (low + high)
        assert abs(wrap_angle(gamma - pose.theta - middle)) <= 0.5 * (high - low) + 5e-3


def test_contact_features_are_checked():
    with pytest.raises(ValueError, match='Contact.index: got 4'):
        contact_point(box(), Contact('vertex', 4))
    with pytest.raises(ValueError, match="Contact.kind: got 'round'"):
        contact_point(box(), Contact('round'))
    with pytest.raises(ValueError, match='Contact.offset'):
        contact_point(box(), Contact('face', 0, 0.21))


def test_a_flat_pusher_meets_the_vertex_that_is_foremost():
    obj, pose = box(), Pose(1.0, 2.0, 0.3)
    contact, gamma, gap = find_contact(obj, pose, Pose(0.0, 0.0, 0.5), FLAT_PUSHER)
    corners = [pose.transform(corner) for corner in obj.outline]
    heights = [x * math.cos(0.5) + y * math.sin(0.5) for x, y in corners]
    assert contact == Contact('vertex', int(np.argmin(heights))) and gamma == 0.5
    assert gap == pytest.approx(min(heights))
    contact, _, gap = find_contact(bin_(), pose, Pose(0.0, 0.0, 0.5), FLAT_PUSHER)
    x, y = pose.transform(contact_point(bin_(), contact))
    assert x * math.cos(0.5) + y * math.sin(0.5) == pytest.approx(gap)
    with pytest.raises(ValueError, match='robot_pose: .* flat pusher'):
        find_contact(obj, pose, (0.0, 0.0), FLAT_PUSHER)
