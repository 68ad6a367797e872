"""Parameters refuse what makes no sense; contact geometry, friction and paths obey their laws."""

import dataclasses
import math

from helpers.objects import bin_, box, square_outline
import numpy as np
from push_model.contact import contact_point, find_contact, normal_range, rolling_constants
from push_model.dubins import dubins_paths
from push_model.friction import c_squared, friction_center, friction_weight
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import Contact, PushedObject, RoundRobot, Support
from push_model.quasi_static import (
    compare_yaw_rates, ellipsoid_yaw_rate, quasi_static_yaw_rate, vehicle,
)
from push_model.trajectory import COLUMNS, PushTrajectory
import pytest


@pytest.mark.parametrize('change, words_expected', [
    ({'mass': float('nan')}, ('PushedObject.mass', 'nan', 'above 0', 'kg')),
    ({'mass': '2'}, ('PushedObject.mass', "'2'", 'finite number')),
    ({'mass': True}, ('PushedObject.mass', 'True')),
    ({'inertia': -0.1}, ('PushedObject.inertia', 'at least 0')),
    ({'supports': ()}, ('PushedObject.supports', 'at least one')),
    ({'supports': (1.0,)}, ('PushedObject.supports', '1.0', 'Support')),
    ({'outline': square_outline()[::-1]}, ('PushedObject.outline', 'convex')),
    ({'outline': square_outline()[:2]}, ('PushedObject.outline', '2 vertices')),
    ({'outline': ()}, ('PushedObject.outline', 'radius')),
    ({'radius': 0.2}, ('PushedObject.outline', 'not both')),
    ({'center_of_mass': (0.0,)}, ('PushedObject.center_of_mass', 'two numbers')),
    ({'center_of_mass': (0.0, math.inf)}, ('PushedObject.center_of_mass', 'inf')),
])
def test_object_refuses_bad_fields(change, words_expected):
    with pytest.raises(ValueError) as error:
        dataclasses.replace(box(), **change)
    for word in words_expected:
        assert word in str(error.value)


def test_star_is_not_convex():
    star = [(math.cos(a), math.sin(a)) for a in np.arange(5) * 4 * math.pi / 5]
    with pytest.raises(ValueError, match='convex'):
        dataclasses.replace(box(), outline=star)


def test_robot_refuses_an_unknown_drive():
    with pytest.raises(ValueError, match=r"RoundRobot.drive: got 'tracked', expected one of diff"):
        RoundRobot(radius=0.17, drive='tracked')
    with pytest.raises(ValueError, match=r'RoundRobot.radius: got -1, expected .* at least 0'):
        RoundRobot(radius=-1)


def test_numbers_are_normalised():
    obj = box(mass=2)
    assert isinstance(obj.mass, float)
    assert dataclasses.replace(obj, outline=np.array(square_outline())).outline == obj.outline
    with pytest.raises(dataclasses.FrozenInstanceError):
        obj.mass = 3.0


def test_loads_carry_the_weight_and_follow_the_shares():
    supports = [Support(0.1, 0, 0.3, 1.0), Support(-0.1, 0, 0.2, 3.0)]
    obj = PushedObject(mass=2.0, inertia=0.1, supports=supports, radius=0.2,
                       center_of_mass=(-0.05, 0.0))
    assert sum(obj.loads) == pytest.approx(2.0 * 9.81)
    assert obj.loads[1] == pytest.approx(3 * obj.loads[0])
    assert friction_center(obj)[0] == pytest.approx(0.1 * (0.3 - 0.6) / (0.3 + 0.6))


@pytest.mark.physics
@pytest.mark.parametrize('robot, surface, expected', [
    (0.17, 0.0, (0.0, 0.0)), (0.17, math.inf, (1.0, 0.17)), (0.0, 0.3, (1.0, 0.0)),
    (math.inf, 0.3, (0.0, 0.3)), (0.2, 0.2, (0.5, 0.1)), (0.0, math.inf, (1.0, 0.0))])
def test_rolling_limits(robot, surface, expected):
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
        place = pose.x + away * math.cos(bearing), pose.y + away * math.sin(bearing)
        contact, gamma, gap = find_contact(obj, pose, place, 0.1)
        x, y = pose.transform(contact_point(obj, contact))
        reach = gap + 0.1
        assert place == pytest.approx((x - reach * math.cos(gamma), y - reach * math.sin(gamma)),
                                      abs=2e-3 if contact.kind == 'vertex' else 1e-9)
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


def test_friction_weight_tends_to_coulomb():
    speeds = np.array([1e-3, 1e-2, 1.0])
    forces = friction_weight(5.0, speeds, 0.0 * speeds, 1e-5) * speeds
    assert forces == pytest.approx(5.0, rel=1e-4)
    assert (forces < 5.0).all()


@pytest.mark.physics
def test_square_pushed_at_mid_face_has_a_wheelbase_of_its_side():
    assert vehicle(box(), (-0.2, 0.0)).wheelbase == pytest.approx(0.4)


@pytest.mark.physics
def test_ellipsoid_turns_a_square_by_a_third_less_than_its_supports_do():
    """Wheelbase l on the supports, 1.5 l by the ellipsoid: near straight, the turn goes as 1/L."""
    near, far = compare_yaw_rates(box(), (-0.2, 0.0), (1e-4, 1.5))
    for found, wheelbase in zip(near[1:], (0.4, 0.4, 0.6)):
        assert -1e-4 / found == pytest.approx(wheelbase, rel=1e-3)
    assert 0.85 < far.ellipsoid / far.supports < 0.95
    assert far.near_straight / far.supports > 1.3


@pytest.mark.physics
@pytest.mark.parametrize('seed', range(4))
def test_ellipsoid_with_mean_square_meets_the_supports_near_straight(seed):
    rng = np.random.default_rng(seed)
    obj = box(friction=rng.uniform(0.1, 0.5, 4))
    point = (-0.2, -0.2)
    view = vehicle(obj, point)
    for small in (1e-3, 2e-3):
        v_x, v_y = math.cos(view.angle + small), math.sin(view.angle + small)
        f_x, f_y = friction_center(obj)
        omega = ellipsoid_yaw_rate(c_squared(obj, view.angle), point[0] - f_x,
                                   point[1] - f_y, v_x, v_y)
        true = quasi_static_yaw_rate(obj, point, v_x, v_y)
        assert omega == pytest.approx(true, rel=20 * small)
        z_x, z_y = view.flat_output[0] - point[0], view.flat_output[1] - point[1]
        sideways = (-(v_x - true * z_y) * math.sin(view.angle)
                    + (v_y + true * z_x) * math.cos(view.angle))
        assert abs(sideways) < 0.02 * small


@pytest.mark.physics
def test_turning_rate_is_isotropic_in_speed_and_zero_at_rest():
    slow, fast = (quasi_static_yaw_rate(box(), (-0.2, 0.0), v, 0.3 * v) for v in (0.01, 1.0))
    assert fast == pytest.approx(100 * slow, rel=1e-6)
    assert quasi_static_yaw_rate(box(), (-0.2, 0.0), 0.0, 0.0) == 0.0
    with pytest.raises(ValueError, match='friction centre itself'):
        vehicle(box(), (0.0, 0.0))


def test_dubins_paths_arrive_and_mirror():
    rng = np.random.default_rng(1)
    for _ in range(300):
        start, goal = Pose(*rng.uniform(-3, 3, 3)), Pose(*rng.uniform(-3, 3, 3))
        left, right = rng.uniform(0.2, 1.5, 2)
        found = dubins_paths(start, goal, left, right)
        assert {'LSL', 'RSR'} <= {path.word for path in found}
        for path in found:
            end, _ = path.at(path.length)
            assert end[:2] == pytest.approx(goal[:2], abs=1e-9)
            assert wrap_angle(end.theta - goal.theta) == pytest.approx(0.0, abs=1e-9)
        flipped = dubins_paths(*(Pose(p.x, -p.y, -p.theta) for p in (start, goal)), right, left)
        assert flipped[0].length == pytest.approx(found[0].length, abs=1e-9)


def test_dubins_known_lengths():
    ahead = dubins_paths(Pose(0, 0, 0), Pose(5, 0, 0), 1.0, 0.5)[0]
    assert ahead.length == pytest.approx(5.0)
    u_turn = dubins_paths(Pose(0, 0, 0), Pose(0, 2, math.pi), 1.0, 1.0)[0]
    assert u_turn.length == pytest.approx(math.pi)
    with pytest.raises(ValueError, match='radius R'):
        dubins_paths(Pose(0, 0, 0), Pose(1, 0, 0), 1.0, 0.0)


def arrays(count=3):
    """Return the arrays of a straight trajectory."""
    rows = np.linspace(0.0, 1.0, count)[:, None] * np.ones(3)
    return {'times': np.linspace(0.0, 2.0, count), **{name: rows.copy() for name in COLUMNS}}


def test_trajectory_is_checked_frozen_and_kept(tmp_path):
    trajectory = PushTrajectory(**arrays())
    with pytest.raises(ValueError):
        trajectory.object_poses[0, 0] = 1.0
    trajectory.save(tmp_path / 'push.npz')
    again = PushTrajectory.load(tmp_path / 'push.npz')
    for name in ('times',) + COLUMNS:
        assert np.array_equal(getattr(again, name), getattr(trajectory, name))
    assert trajectory.at(1.0)['object_poses'] == pytest.approx([0.5] * 3)
    assert trajectory.at(9.0)['robot_poses'] == pytest.approx([1.0] * 3)
    assert trajectory.path_length == pytest.approx(math.sqrt(2))


@pytest.mark.parametrize('name, value, text', [
    ('object_poses', np.zeros((3, 2)), r'object_poses: got shape \(3, 2\), expected \(3, 3\)'),
    ('robot_twists', np.full((3, 3), np.nan), r'robot_twists: got a value that is not finite'),
    ('times', np.array([0.0, 1.0, 1.0]), 'increasing'),
    ('times', np.array([0.5, 1.0, 2.0]), 'from 0')])
def test_trajectory_refuses(name, value, text):
    with pytest.raises(ValueError, match=text):
        PushTrajectory(**{**arrays(), name: value})
