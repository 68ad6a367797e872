"""
The physics of single-point pushing, written once.

This module names what a notebook needs; code of the packages imports from the modules themselves.
"""

from push_model.contact import contact_point, find_contact, FoundContact, normal_range
from push_model.friction import friction_center, with_friction_center
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.parameters import Contact, PushedObject, RoundRobot, Support
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.quasi_static import quasi_static_yaw_rate, Vehicle, vehicle
from push_model.signals import ObjectPose, Odometry, PoseCovariance, STOP, Twist
from push_model.trajectory import PushStyle, PushTrajectory

__all__ = [
    'Contact', 'contact_point', 'find_contact', 'FloatArray', 'FoundContact',
    'friction_center', 'normal_range', 'ObjectPose', 'Odometry', 'PlanFailure', 'PlanRequest',
    'Pose', 'PoseCovariance', 'PushedObject', 'PushStyle', 'PushTrajectory',
    'quasi_static_yaw_rate', 'RoundRobot', 'STOP', 'Support', 'Twist', 'Vehicle', 'vehicle',
    'with_friction_center', 'wrap_angle',
]
