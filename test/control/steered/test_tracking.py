"""Tracking: the path length of the contact, however the robot turns."""

import math

from helpers.contact_sites import SITES
from helpers.objects import bin_, box
from push_control.settings import ControlSettings
from push_control.steered.estimation.limit_surface_table import LimitSurfaceTable
from push_control.steered.estimation.push_motion import PushMotion
from push_control.steered.tracking import PushTracker
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.signals import ObjectPose, Odometry, Twist
import pytest


def spinning_push(site, speed, spin, duration=3.0, step=0.01):
    """
    Push at a speed through the centre, which does not turn the object, and spin meanwhile.

    Yields observations of the object at rest at first in the origin, and of the robot.
    """
    x = y = 0.0
    for k in range(round(duration / step) + 1):
        phi = site.heading + spin * k * step
        c_x, c_y, normal = site.contact_at(phi)
        ratio = speed / math.hypot(c_x, c_y)
        v_x = -ratio * c_x + spin * site.robot_radius * math.sin(normal)
        v_y = -ratio * c_y - spin * site.robot_radius * math.cos(normal)
        pose = Pose(x, y, 0.0)
        robot = Pose(*site.robot_center(pose, phi), phi)
        twist = Twist(*robot.inverse().rotate((v_x, v_y)), spin)
        time = k * step
        yield Observation(time, Odometry(time, robot, twist), ObjectPose(time, pose))
        x, y = x - step * ratio * c_x, y - step * ratio * c_y


@pytest.mark.parametrize('spin', [-0.4, 0.0, 0.4])
@pytest.mark.parametrize('kind', ['vertex', 'face', 'round'])
def test_the_travelled_distance_is_that_of_the_contact(kind, spin):
    """However far a free base spins meanwhile, and so rolls its contact."""
    site, obj = SITES[kind], bin_() if kind == 'round' else box()
    observations = spinning_push(site, 0.1, spin)
    motion, first = PushMotion(0.17, site, LimitSurfaceTable(obj, site.point)), next(observations)
    tracker = PushTracker(motion, ControlSettings(), (0.0, 0.0), first.object_pose,
                          first.odometry)
    for observation in observations:
        assert tracker.observe(observation) is None
    assert tracker.travelled_distance == pytest.approx(0.1 * 3.0, rel=0.01)
