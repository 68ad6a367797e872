"""Beams that see the object, compared with points along them."""

import math

import numpy as np
from push_localization.object_beams import sees_object
from push_localization.scan_points import ScanPoints
from push_model.contact import robot_gap
from push_model.files import data
from push_model.files.parameter_files import read_object
from push_model.geometry import Pose
import pytest

MARGIN = 0.05


def beams(lens, ranges):
    """Make beams all round a lens."""
    angles = np.linspace(-math.pi, math.pi, len(ranges), endpoint=False)
    lenses = np.tile(np.array(lens), (len(ranges), 1))
    points = lenses + np.asarray(ranges)[:, None] * np.column_stack(
        [np.cos(angles), np.sin(angles)])
    return ScanPoints(0.0, points, lenses, np.zeros(len(ranges)))


@pytest.mark.parametrize('name', ['box_04', 'bin'])
@pytest.mark.parametrize('seed', range(3))
def test_beams_that_come_within_the_margin_are_those(name, seed):
    """The nearest of many points of each beam tells, but where it is close to the margin."""
    rng = np.random.default_rng(seed)
    obj = read_object(data.config_file(f'objects/{name}.yaml'))
    pose = Pose(*rng.uniform(-1.0, 1.0, 2), rng.uniform(-3.0, 3.0))
    bearing, away = rng.uniform(-math.pi, math.pi), rng.uniform(0.5, 1.5)
    lens = pose.x + away * math.cos(bearing), pose.y + away * math.sin(bearing)
    scan = beams(lens, rng.uniform(0.2, 3.0, 90))
    sees = sees_object(scan, obj, pose, MARGIN)
    fractions = np.linspace(0.0, 1.0, 200)
    for index in range(len(sees)):
        along = scan.lenses[index] + fractions[:, None] * (scan.points - scan.lenses)[index]
        # A corner of the widened outline is farther from the object than its sides.
        gap = min(robot_gap(obj, pose, Pose(x, y, 0.0), 0.0) for x, y in along.tolist())
        if sees[index]:
            assert gap < MARGIN * math.sqrt(2.0) + 0.01
        else:
            assert gap > MARGIN - 0.005
    assert 0 < sees.sum() < len(sees)


def test_a_lidar_within_the_margin_leaves_out_the_angle_of_the_object():
    """Beams to the object go, those away from it stay."""
    obj = read_object(data.config_file('objects/box_04.yaml'))
    front = max(x for x, _ in obj.outline)
    scan = beams((front + 0.02, 0.0), np.full(360, 2.0))
    sees = sees_object(scan, obj, Pose(0.0, 0.0, 0.0), MARGIN)
    directions = (scan.points - scan.lenses)[:, 0]
    assert sees[directions < -0.2].all()
    assert not sees[directions > 0.3].any()
