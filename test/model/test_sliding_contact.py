"""Slow pushes that stick or slide: against the quasi-static limit, and their own symmetries."""

import dataclasses
import math

from helpers.objects import box
import numpy as np
from push_model.analysis.sliding_contact import contact_motion, motion_cone, SupportArrays
from push_model.quasi_static import quasi_static_yaw_rate
import pytest
from studies.analysis.rolling_limits import quasi_static_force

pytestmark = pytest.mark.physics
OBJECT = dataclasses.replace(box(), center_of_mass=(0.03, -0.02))
SUPPORTS = SupportArrays.of(OBJECT)
ANGLES = np.linspace(-1.2, 1.2, 25)
PUSHES = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
POINTS = np.tile((-0.2, 0.05), (len(ANGLES), 1))
NORMALS = np.zeros(len(ANGLES))
FRICTION = 0.4


def test_a_sticking_contact_moves_as_the_quasi_static_limit_has_it():
    motion = contact_motion(SUPPORTS, POINTS, NORMALS, PUSHES, math.inf)
    assert (motion.slides == 0).all()
    for push, rate, force in zip(PUSHES, motion.yaw_rates, motion.forces):
        assert rate == pytest.approx(quasi_static_yaw_rate(OBJECT, POINTS[0], *push), abs=1e-6)
        assert force == pytest.approx(quasi_static_force(OBJECT, POINTS[0], *push), abs=1e-3)


def test_a_push_slides_where_it_leaves_the_motion_cone():
    motion = contact_motion(SUPPORTS, POINTS, NORMALS, PUSHES, FRICTION)
    low, high = motion_cone(SUPPORTS, POINTS[:1], NORMALS[:1], FRICTION)[0]
    assert low < high
    assert ((motion.slides == 0) == ((ANGLES > low) & (ANGLES < high))).all()
    assert np.abs(motion.force_angles).max() <= math.atan(FRICTION) + 1e-8


def test_a_sliding_contact_keeps_normal_velocity_cone_edge_and_moments():
    motion = contact_motion(SUPPORTS, POINTS, NORMALS, PUSHES, FRICTION)
    assert motion.velocities[:, 0] == pytest.approx(PUSHES[:, 0])
    slides = motion.slides != 0
    assert slides.any()
    angles = np.arctan2(motion.forces[slides, 1], motion.forces[slides, 0])
    assert angles == pytest.approx(motion.slides[slides] * math.atan(FRICTION), abs=1e-4)
    # The contact slides against the tangential force.
    slip = (PUSHES - motion.velocities)[slides, 1]
    assert (np.sign(slip) == motion.slides[slides]).all()
    # The force is that of a sticking contact with the velocity that the object has there.
    for velocity, rate in zip(motion.velocities[slides], motion.yaw_rates[slides]):
        assert rate == pytest.approx(quasi_static_yaw_rate(OBJECT, POINTS[0], *velocity),
                                     abs=1e-4)
