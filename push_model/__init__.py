"""
The physics of single-point pushing, written once.

This module names what a notebook needs; code of the packages imports from the modules themselves.
They are imported at first use.
"""

from typing import TYPE_CHECKING

from push_model.files.lazy_names import lazy_names

if TYPE_CHECKING:
    from push_model.contact import contact_point, find_contact, NearestContact, normal_range
    from push_model.friction import friction_center, with_friction_center
    from push_model.geometry import convex_hull, FloatArray, Pose, wrap_angle
    from push_model.parameters import Contact, PushedObject, RoundRobot, Support
    from push_model.plan_request import PlanFailure, PlanRequest
    from push_model.quasi_static import quasi_static_yaw_rate, Vehicle, vehicle
    from push_model.signals import ObjectPose, Odometry, PoseCovariance, STOP, Twist
    from push_model.trajectory import PushLine, PushStyle, PushTrajectory

__all__ = [
    'Contact', 'contact_point', 'convex_hull', 'find_contact', 'FloatArray', 'friction_center',
    'NearestContact', 'normal_range', 'ObjectPose', 'Odometry', 'PlanFailure', 'PlanRequest',
    'Pose', 'PoseCovariance', 'PushedObject', 'PushLine', 'PushStyle', 'PushTrajectory',
    'quasi_static_yaw_rate', 'RoundRobot', 'STOP', 'Support', 'Twist', 'Vehicle', 'vehicle',
    'with_friction_center', 'wrap_angle',
]

__getattr__, __dir__ = lazy_names(__name__, {
    'push_model.contact': ('contact_point', 'find_contact', 'NearestContact', 'normal_range'),
    'push_model.friction': ('friction_center', 'with_friction_center'),
    'push_model.geometry': ('convex_hull', 'FloatArray', 'Pose', 'wrap_angle'),
    'push_model.parameters': ('Contact', 'PushedObject', 'RoundRobot', 'Support'),
    'push_model.plan_request': ('PlanFailure', 'PlanRequest'),
    'push_model.quasi_static': ('quasi_static_yaw_rate', 'Vehicle', 'vehicle'),
    'push_model.signals': ('ObjectPose', 'Odometry', 'PoseCovariance', 'STOP', 'Twist'),
    'push_model.trajectory': ('PushLine', 'PushStyle', 'PushTrajectory'),
})
