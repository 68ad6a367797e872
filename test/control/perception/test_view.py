"""Laws of the view: frames, limits and margins."""

import math

from push_control.perception.view import bearing, View
from push_control.supervision_settings import SupervisionSettings
from push_model.geometry import Pose, wrap_angle
import pytest

CAMERA = View(half_angle=0.6, nearest=0.15, farthest=3.0)
OBJECT = Pose(1.0, 0.0, 0.7)
ORIGIN = Pose(0.0, 0.0, 0.0)


def test_by_default_poses_are_expected_everywhere():
    view = View.from_settings(SupervisionSettings())
    assert not SupervisionSettings().has_limited_view
    for heading in (0.0, 1.0, math.pi, -2.0):
        assert view.expects(Pose(0.0, 0.0, heading), OBJECT, -0.01, 1.0, 1.0)


@pytest.mark.parametrize('name, value', [
    ('view_angle', 1.0), ('view_nearest', 0.1), ('view_farthest', 5.0)])
def test_each_setting_limits_the_view(name, value):
    assert SupervisionSettings(**{name: value}).has_limited_view


@pytest.mark.parametrize('motion', [Pose(3.0, -2.0, 2.5), Pose(-1.0, 4.0, -3.0)])
@pytest.mark.parametrize('heading', [0.0, 0.45, 0.55, 3.0])
def test_where_the_world_has_its_origin_does_not_matter(motion, heading):
    robot = Pose(0.0, 0.0, heading)
    assert (CAMERA.expects(robot, OBJECT, 0.5)
            == CAMERA.expects(motion @ robot, motion @ OBJECT, 0.5))


def test_left_and_right_are_alike():
    for angle in (0.3, 0.49, 0.51, 1.0):
        left, right = Pose(0.0, 0.0, angle), Pose(0.0, 0.0, -angle)
        assert bearing(left, OBJECT) == pytest.approx(-bearing(right, OBJECT))
        assert CAMERA.expects(left, OBJECT, 0.5) == CAMERA.expects(right, OBJECT, 0.5)


def test_the_bearing_is_that_of_the_robots_axes():
    assert bearing(ORIGIN, Pose(0.0, 2.0, 0.0)) == pytest.approx(math.pi / 2)
    assert bearing(Pose(1.0, 1.0, math.pi), ORIGIN) == pytest.approx(
        wrap_angle(math.atan2(-1.0, -1.0) - math.pi))


@pytest.mark.parametrize('robot, gap, is_expected', [
    (ORIGIN, 0.19, True), (ORIGIN, 0.17, False),
    (Pose(0.0, 0.0, 0.45), 0.5, True), (Pose(0.0, 0.0, 0.55), 0.5, False),
    (Pose(-1.9, 0.0, 0.0), 2.5, True), (Pose(-2.1, 0.0, 0.0), 2.7, False)])
def test_each_limit_counts_with_its_margin(robot, gap, is_expected):
    assert CAMERA.expects(robot, OBJECT, gap) is is_expected


def test_the_less_certain_the_fewer_poses_are_expected():
    robot = Pose(0.0, 0.0, 0.45)
    stds = [0.0, 0.005, 0.02, 0.05, 0.2]
    for gap in (0.19, 0.3):
        near = [CAMERA.expects(ORIGIN, OBJECT, gap, std) for std in stds]
        aside = [CAMERA.expects(robot, OBJECT, 1.0, 0.0, std) for std in stds]
        assert near == sorted(near, reverse=True) and aside == sorted(aside, reverse=True)
        assert aside[0] and not aside[-1]
    assert not CAMERA.expects(ORIGIN, OBJECT, 0.19, 0.05)


def test_a_robot_on_top_of_the_origin_has_an_answer():
    assert View(half_angle=1.0).faces(ORIGIN, ORIGIN)
    assert not View(half_angle=1.0).faces(ORIGIN, ORIGIN, position_std=0.1)
