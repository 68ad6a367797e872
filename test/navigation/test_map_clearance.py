"""Clearance of a robot whose place is uncertain: at least what is to be expected of its error."""

import math

from helpers.maps import room_with_door, walled_room
from helpers.objects import box
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_navigation.approach.approach_path import plan_approach
from push_navigation.map_clearance import MapClearance, MapContext, PositionUncertainty
from push_navigation.path import NoPathFound, PathFailure, sample_path
from push_navigation.path_planner import plan_path
from push_navigation.settings import DriveSettings
import pytest

ROBOT = RoundRobot(0.17, 'differential')
SETTINGS = DriveSettings()
# A robot that has just started: 2 % of the way, and 0.02 rad/m.
DRIFTING = PositionUncertainty(0.005, 0.02, 0.02)
ASIDE = Pose(-1.5, -2.2, 0.4)


def drawn_errors(rows, uncertainty):
    """Errors of robots that follow a path by odometries with such errors, as complex numbers."""
    rng = np.random.default_rng(1)
    steps = np.diff(rows[:, :2], axis=0)
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*steps.T))])[:-1]
    ends = []
    for _ in range(400):
        heading, scale = rng.normal(0.0, uncertainty.slope, 2)
        turned = heading + rng.normal(0.0, uncertainty.drift) * lengths
        moved = steps[:, 0] + 1j * steps[:, 1]
        moved = moved * (1.0 + scale) * np.exp(1j * turned)
        start = rng.normal(0.0, uncertainty.position, 2) @ (1.0, 1j)
        ends.append(start + np.concatenate([[0.0], np.cumsum(moved)]))
    return np.array(ends) - (rows[:, 0] - rows[0, 0]) - 1j * (rows[:, 1] - rows[0, 1])


def true_deviations(rows, uncertainty):
    errors = drawn_errors(rows, uncertainty)
    return np.maximum(errors.real.std(axis=0), errors.imag.std(axis=0))


def gaps(occupancy_map, rows):
    return occupancy_map.clearance(rows[:, :2]) - ROBOT.radius


@pytest.mark.parametrize('goal', [Pose(1.5, 0.0, 0.0), Pose(2.3, -1.5, 1.0)])
def test_a_path_keeps_at_least_the_expected_deviation(goal):
    """That of robots drawn with such errors, whichever clearance was left for the path."""
    occupancy_map = room_with_door(0.8)
    path = plan_path(ROBOT, box(), ASIDE, Pose(-2.0, 0.0, 0.0), goal, SETTINGS,
                     occupancy_map=occupancy_map, uncertainty=DRIFTING)
    rows = sample_path(path, ROBOT, 0.02)
    deviations = true_deviations(rows, DRIFTING)
    assert deviations.max() > SETTINGS.map_clearance
    assert (gaps(occupancy_map, rows) >= deviations - 1e-3).all()


def test_robots_that_drift_along_a_hallway_pass_the_door_at_its_side():
    """Of robots drawn so, no more touch than deviate by 1.5 standard deviations."""
    # A hallway of 1.2 m, and a door of 0.9 m out of it.
    occupancy_map = walled_room((-3.0, 1.6, -0.05, 0.05), (2.5, 3.0, -0.05, 0.05),
                                (-3.0, 3.0, 1.25, 3.0))
    path = plan_path(ROBOT, box(), ASIDE, Pose(-2.5, 0.65, 0.0), Pose(1.9, -1.5, 0.0), SETTINGS,
                     occupancy_map=occupancy_map, uncertainty=DRIFTING)
    rows = sample_path(path, ROBOT, 0.05)
    errors = drawn_errors(rows, DRIFTING)
    places = np.stack([rows[:, 0] + errors.real, rows[:, 1] + errors.imag], axis=-1)
    clearances = occupancy_map.clearance(places.reshape(-1, 2)).reshape(errors.shape)
    assert abs(errors[:, -1]).std() > 0.1
    assert (clearances.min(axis=1) < ROBOT.radius).mean() < math.erfc(1.5 / math.sqrt(2.0))


def test_the_prediction_is_that_of_drawn_robots():
    """Along a straight line, to a few per cent; a tenth more round a corner."""
    straight = np.array([(0.05 * i, 0.0, 0.0) for i in range(61)])
    corner = np.array([(min(0.05 * i, 1.5), max(0.0, 0.05 * i - 1.5), 0.0) for i in range(61)])
    for rows in (straight, corner):
        away = np.hypot(*(rows[:, :2] - rows[0, :2]).T)
        predicted = DRIFTING.deviations(0.05 * np.arange(len(rows)), away)
        true = true_deviations(rows, DRIFTING)
        assert (predicted > 0.9 * true).all() and predicted[-1] < 1.3 * true[-1]


def test_contacts_beside_a_wall_are_not_for_robots_that_may_be_elsewhere():
    """From near by, or with a certain place, they are; else the reason says why not."""
    # Between the contact and the wall there are 7 cm of room for the robot.
    occupancy_map = walled_room()
    object_pose = Pose(0.0, 2.5, 0.0)
    contact = Pose(-0.37, 2.66, 0.0)
    far, near = Pose(-2.5, -2.0, 0.5), Pose(-1.0, 2.4, 0.0)
    for start, uncertainty in ((far, PositionUncertainty()), (near, DRIFTING)):
        plan_approach(ROBOT, box(), object_pose, start, contact, SETTINGS,
                      occupancy_map=occupancy_map, uncertainty=uncertainty)
    with pytest.raises(NoPathFound) as failure:
        plan_approach(ROBOT, box(), object_pose, far, contact, SETTINGS,
                      occupancy_map=occupancy_map, uncertainty=DRIFTING)
    assert failure.value.report.code is PathFailure.GOAL_TOO_UNCERTAIN


def test_a_robot_that_starts_beside_a_wall_may_leave_it():
    """It has less than its place is uncertain by, and gains clearance on the way."""
    occupancy_map = walled_room()
    start = Pose(0.0, 3.0 - ROBOT.radius - 0.06, 0.0)
    path = plan_path(ROBOT, box(), ASIDE, start, Pose(1.0, 0.0, 0.0), SETTINGS,
                     occupancy_map=occupancy_map, uncertainty=PositionUncertainty(0.05, 0.02, 0.0))
    found = gaps(occupancy_map, sample_path(path, ROBOT, 0.02))
    assert math.isclose(found.min(), found[0], abs_tol=0.01)


@pytest.mark.parametrize('bend', [0.0, 1.2])
def test_the_ellipse_of_a_place_is_that_of_drawn_robots(bend: float) -> None:
    """Its axes and direction at the end of a straight and of a bent way."""
    uncertainty = PositionUncertainty(0.02, 0.01, 0.03)
    angles = np.linspace(0.0, bend, 200)
    steps = 4.0 / 199.0 * np.column_stack([np.cos(angles), np.sin(angles)])
    points = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)[:-1]])
    rows = np.column_stack([points, angles])
    occupancy_map = walled_room(side=10.0)
    margins = MapClearance(MapContext(occupancy_map, uncertainty, 20.0), ROBOT.radius, (0.0, 0.0),
                           0.05, math.inf)
    shortfall = margins.shortfall(rows)
    assert shortfall is not None
    assert (shortfall.x, shortfall.y) == pytest.approx(points[-1].tolist(), abs=1e-9)
    errors = drawn_errors(rows, uncertainty)[:, -1]
    variances, axes = np.linalg.eigh(np.cov(errors.real, errors.imag))
    minor, major = np.sqrt(variances).tolist()
    # 400 robots know their deviation to a twentieth.
    assert shortfall.ellipse.major == pytest.approx(major, rel=0.15)
    assert shortfall.ellipse.minor == pytest.approx(minor, rel=0.35)
    direction = math.atan2(axes[1, 1], axes[0, 1])
    assert math.sin(shortfall.ellipse.angle - direction) == pytest.approx(0.0, abs=0.1)
