"""Contacts of a box and of a disc with a robot, and trajectories that start from them."""

import math

import numpy as np
from push_control.steered.estimation.contact_site import RollingContact
from push_control.steered.path.path import flat_output_pose
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_model.quasi_static import vehicle
from push_model.trajectory import PushTrajectory

UNLIMITED = (-math.inf, math.inf)
VERTEX = RollingContact(0.0, 0.17, 0.0, (-0.2, -0.2), math.pi / 4, math.pi / 4,
                        (0.0, math.pi / 2))
FACE = RollingContact(1.0, 0.17, math.inf, (-0.2, 0.03), 0.0, 0.1, UNLIMITED, (-0.2, 0.2))
ROUND = RollingContact(0.2 / 0.37, 0.17, 0.2, (-0.2, 0.0), 0.0, -0.1, UNLIMITED)
# The same contacts, with the robot at other angles.
SITES = {'vertex': VERTEX._replace(normal=0.8, heading=0.6), 'face': FACE,
         'round': ROUND._replace(heading=0.1)}


def arc_trajectory(obj: PushedObject, site: RollingContact, curvature: float,
                   length: float) -> PushTrajectory:
    """Carry the flat output along an arc; contact and robot follow."""
    local = flat_output_pose(vehicle(obj, site.point))
    base = Pose(*site.point, site.normal) @ Pose(-site.robot_radius, 0.0,
                                                 site.heading - site.normal)
    arc_lengths = np.linspace(0.0, length, 40)
    poses = [Pose((math.sin(curvature * s)) / curvature, (1.0 - math.cos(curvature * s))
                  / curvature, curvature * s) @ local.inverse() for s in arc_lengths.tolist()]
    contacts = [pose @ Pose(*site.point, site.normal) for pose in poses]
    zeros = np.zeros((40, 3))
    return PushTrajectory(arc_lengths / 0.1, np.array(poses), zeros, np.array(contacts), zeros,
                          np.array([pose @ base for pose in poses]), zeros)
