"""Requests for plans and maps survive the way through messages, and bad ones are refused."""

import dataclasses
import functools
import math
import re

from helpers.objects import box
from nav_msgs.msg import OccupancyGrid
import numpy as np
from push_model.friction import with_friction_center
from push_model.geometry import Pose
from push_model.parameters import PushedObject, Support
from push_model.plan_request import PlanFailure, PlanRequest, RequestKind
from push_navigation.occupancy_map import OccupancyMap
from push_ros.conversions.map import from_map_message, to_map_message
from push_ros.conversions.plan import from_plan_message, no_plan_message, plan_failure
from push_ros.conversions.plan_request import (
    FIELDS, from_request_message, to_request_message,
)
from push_ros.conversions.primitives import exact_stamp, MessageRefused, nanoseconds, to_stamp
import pytest
from rclpy.serialization import deserialize_message, serialize_message

BELIEVED = box(mass=3.0)
WANTED = PlanRequest(Pose(1.0, -2.0, 0.4), Pose(0.2, 3.0, -2.9), Pose(-1.0, 0.5, 3.0),
                     dataclasses.replace(with_friction_center(BELIEVED, (0.02, -0.03)),
                                         contact_friction_coefficient=0.27), 0.64,
                     0.005, 0.02, 0.011, 0.017, 0.06)
NUMBERS = np.arange(35).reshape(5, 7)


@functools.lru_cache(maxsize=None)
def occupancy_map():
    """Make a map, once."""
    return OccupancyMap(0.05, Pose(-1.0, 2.0, 0.7), NUMBERS % 3 == 0)


def sent(message):
    """Send a message through serialization and back."""
    return deserialize_message(serialize_message(message), type(message))


def request():
    """Make a request that is as it should be."""
    return to_request_message(WANTED, to_stamp(2.0), 'odom')


def floor():
    """Make a map that is as it should be."""
    return to_map_message(occupancy_map(), to_stamp(0.0), 'odom')


FIELD_COUNT = len(request().joint_names)


@pytest.mark.parametrize('time', [0, 999_999_999, 1_763_748_000_123_456_789])
def test_exact_stamps_keep_every_nanosecond(time):
    """Also at dates of today, where seconds as a number are too coarse."""
    assert nanoseconds(exact_stamp(time)) == time


@pytest.mark.parametrize('kind', RequestKind)
def test_a_request_says_what_is_wanted(kind):
    """The planner does not know what the controller does."""
    message = to_request_message(WANTED._replace(kind=kind), to_stamp(2.0), 'odom')
    assert from_request_message(sent(message), 'odom').kind is kind


@pytest.mark.parametrize('number', [-1.0, 0.5, float(len(RequestKind))])
def test_a_request_of_no_kind_is_refused(number):
    """It may be of another version."""
    message = request()
    set_field(message, 'kind', number)
    with pytest.raises(MessageRefused, match='push_request: kind: got '):
        from_request_message(sent(message), 'odom')


def test_requests_survive():
    """Poses, goal, tolerances, and an object that pushes as the one that was learnt."""
    back = from_request_message(sent(request()), 'odom')
    for name in ('object_pose', 'robot_pose', 'goal'):
        assert getattr(back, name) == pytest.approx(getattr(WANTED, name), abs=1e-14)
    assert back.cone_fraction == WANTED.cone_fraction
    assert back.obj == WANTED.obj
    assert back[5:] == WANTED[5:]


@pytest.mark.parametrize('obj', [
    PushedObject(mass=2.0, radius=0.3, supports=(Support(0.0, 0.0, 0.4),)),
    dataclasses.replace(BELIEVED, center_of_mass=(0.01, 0.02)),
    dataclasses.replace(BELIEVED, supports=(*BELIEVED.supports, Support(0.01, 0.0, 0.2)))])
def test_a_request_brings_its_object(obj):
    """Of any shape, on any number of supports: whoever reads it need not know the object."""
    message = to_request_message(WANTED._replace(obj=obj), to_stamp(2.0), 'odom')
    assert from_request_message(sent(message), 'odom').obj == obj


@pytest.mark.parametrize('name, text', [
    ('object.contact_friction_coefficient', 'object.contact_friction_coefficient: got -0.1'),
    ('object.supports.friction_coefficient.2', 'object.supports.friction_coefficient: got -0.1'),
    ('object.mass', 'object.mass: got -0.1')])
def test_a_request_with_an_impossible_object_is_refused(name, text):
    """The error names the parameter and what came."""
    message = request()
    set_field(message, name, -0.1)
    with pytest.raises(MessageRefused, match=f'push_request: {text}'):
        from_request_message(sent(message), 'odom')


def _frame(message):
    message.header.frame_id = 'map'


def set_field(message, name, value):
    """Change one number of a request."""
    message.points[0].positions[list(message.joint_names).index(name)] = value


@pytest.mark.parametrize('name', FIELDS)
@pytest.mark.parametrize('value', [math.nan, math.inf])
def test_a_request_with_a_number_that_is_not_finite_is_refused(name, value):
    """The error names the field, what came and what was expected."""
    message = request()
    set_field(message, name, value)
    with pytest.raises(MessageRefused, match=re.escape(
            f'push_request: {name}: got {value:g}, expected a finite number')):
        from_request_message(sent(message), 'odom')


@pytest.mark.parametrize('name', request().joint_names)
def test_a_request_that_lacks_a_field_is_refused(name):
    """The error names the field, or the list that it is missing from."""
    message = request()
    index = list(message.joint_names).index(name)
    del message.joint_names[index], message.points[0].positions[index]
    with pytest.raises(MessageRefused, match=re.escape(name.rstrip('.0123456789'))):
        from_request_message(sent(message), 'odom')


def test_the_order_of_the_fields_of_a_request_does_not_matter():
    """They are found by name."""
    message = request()
    message.joint_names = list(reversed(message.joint_names))
    message.points[0].positions = list(reversed(message.points[0].positions))
    assert (from_request_message(sent(message), 'odom')
            == from_request_message(sent(request()), 'odom'))


def _unknown(message):
    message.joint_names.append('boldness')
    message.points[0].positions.append(0.5)


def _twice(message):
    message.joint_names.append('goal.x')
    message.points[0].positions.append(0.5)


def _short(message):
    message.points[0].positions.pop()


def _no_point(message):
    message.points = []


@pytest.mark.parametrize('spoil, text', [
    (_frame, "got frame 'map', expected 'odom'"),
    (_unknown, 'got the unknown fields boldness, expected object.x, '),
    (_twice, 'goal.x: got more than one, expected one'),
    (_short, f'got {FIELD_COUNT - 1} positions, expected {FIELD_COUNT}'),
    (_no_point, 'got 0 points, expected 1'),
    (lambda m: set_field(m, 'cone_fraction', 1.5),
     'cone_fraction: got 1.5, expected a number above 0, at most 1'),
    (lambda m: set_field(m, 'cone_fraction', 0.0), 'cone_fraction: got 0, expected'),
    (lambda m: set_field(m, 'heading_tolerance', 0.0),
     'heading_tolerance: got 0, expected a number from 0.0001 to 6.3'),
    (lambda m: set_field(m, 'heading_tolerance', 6.4),
     'heading_tolerance: got 6.4, expected a number from 0.0001 to 6.3'),
    (lambda m: set_field(m, 'position_tolerance', 5e-324),
     'position_tolerance: got 4.94066e-324, expected a number from 0.0001 to 1'),
    (lambda m: set_field(m, 'center_deviation', 1e308),
     'center_deviation: got 1e\\+308, expected a finite number of at most 1e\\+07'),
    (lambda m: set_field(m, 'robot_deviation', -0.1),
     'robot_deviation: got -0.1, expected a number of at least 0')])
def test_a_malformed_request_is_refused(spoil, text):
    """With the field, what came and what was expected."""
    message = request()
    spoil(message)
    with pytest.raises(MessageRefused, match=f'push_request: .*{text}'):
        from_request_message(sent(message), 'odom')


def test_maps_survive():
    """Cell by cell, wherever the map lies."""
    back, expected = from_map_message(sent(floor()), 'odom'), occupancy_map()
    assert np.array_equal(back.occupied, expected.occupied)
    assert back.origin == pytest.approx(expected.origin, abs=1e-14)
    points = expected.from_map(np.random.default_rng(1).uniform(-0.1, 0.45, (50, 2)))
    assert back.clearance(points) == pytest.approx(expected.clearance(points), abs=1e-7)


@pytest.mark.parametrize('value, occupied', [(-1, True), (0, False), (49, False), (50, True),
                                             (100, True)])
def test_what_is_unknown_or_likely_is_an_obstacle(value, occupied):
    message = floor()
    message.data[8] = value
    assert from_map_message(message, 'odom').occupied[1, 1] == occupied


def _few_cells(message):
    message.data = message.data[:-1]


def _empty(message):
    message.info.width = message.info.height = 0
    message.data = []


def _coarse(message):
    message.info.resolution = 0.0


def _endless(message):
    message.info.resolution = math.inf


def _lost(message):
    message.info.origin.position.x = math.nan


def _odd(message):
    message.data[3] = 101


@pytest.mark.parametrize('spoil, text', [
    (_frame, "got frame 'map', expected 'odom'"), (_few_cells, 'got 34 cells, expected 7 times 5'),
    (_empty, 'got 0 cells, expected 0 times 0, at least one'),
    (_coarse, 'got the resolution 0, expected a length from 0.001 to 10 m'),
    (_endless, 'got the resolution inf'), (_lost, 'origin: got the position .*nan'),
    (_odd, 'got 101 in cell 3, expected -1 to 100')])
def test_a_bad_map_is_refused(spoil, text):
    """With the field, what came and what was expected."""
    message = floor()
    spoil(message)
    with pytest.raises(MessageRefused, match=f'map: .*{text}'):
        from_map_message(sent(message), 'odom')


def test_a_map_that_nobody_filled_in_is_refused():
    """It has neither cells nor a size of them."""
    message = OccupancyGrid()
    message.header.frame_id = 'odom'
    with pytest.raises(MessageRefused, match='resolution'):
        from_map_message(message, 'odom')


def test_no_plan_is_not_taken_for_a_plan():
    """The answer where there is none has the stamp of its request, and nothing to follow."""
    for code in PlanFailure:
        message = sent(no_plan_message(code, exact_stamp(7), 'odom'))
        assert nanoseconds(message.header.stamp) == 7
        assert list(message.joint_names) == ['failure']
        assert plan_failure(message) is code
        with pytest.raises(MessageRefused, match='push_plan: got the unknown fields failure'):
            from_plan_message(message, 'odom')


@pytest.mark.parametrize('code', [0.0, 0.5, len(PlanFailure) + 1.0, math.nan])
def test_an_unknown_code_of_a_failure_is_no_plan_either(code):
    """A planner of another version may have reasons of its own."""
    message = no_plan_message(PlanFailure.BLOCKED, exact_stamp(7), 'odom')
    message.points[0].positions[0] = code
    assert plan_failure(sent(message)) is PlanFailure.INVALID_PLAN


def test_an_empty_message_is_no_plan():
    """Nor is a failure without its code."""
    message = no_plan_message(PlanFailure.BLOCKED, exact_stamp(7), 'odom')
    message.points[0].positions = []
    for empty in (type(message)(), message):
        assert plan_failure(sent(empty)) is PlanFailure.INVALID_PLAN
