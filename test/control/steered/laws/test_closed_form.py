"""The closed-form law: signs, saturation and convergence."""

import math

import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.laws.closed_form import feedback_curvature
import pytest
from scipy.integrate import solve_ivp

SETTINGS = ControlSettings()


def test_left_of_the_path_steers_right_and_so_does_a_heading_to_the_left():
    """Each error alone asks for curvature against it; none asks for the path's own."""
    assert feedback_curvature(0.02, 0.0, 0.0, SETTINGS) < 0.0 < feedback_curvature(-0.02, 0.0, 0.0,
                                                                                   SETTINGS)
    assert feedback_curvature(0.0, 0.05, 0.0, SETTINGS) < 0.0 < feedback_curvature(0.0, -0.05, 0.0,
                                                                                   SETTINGS)
    assert feedback_curvature(0.0, 0.0, 0.4, SETTINGS) == 0.4


def test_far_from_the_path_the_law_does_not_pull_harder():
    """The lateral error saturates, the heading error does not."""
    at_bound = feedback_curvature(SETTINGS.lateral_saturation, 0.0, 0.0, SETTINGS)
    assert feedback_curvature(5.0, 0.0, 0.0, SETTINGS) == at_bound
    assert feedback_curvature(5.0, 0.3, 0.0, SETTINGS) < at_bound


@pytest.mark.parametrize('start', [(0.05, 0.0), (-0.1, 0.2), (0.08, -0.1)])
def test_a_flat_point_that_obeys_comes_to_its_path(start):
    """Unlimited, the errors of ``y' = sin psi, psi' = kappa`` vanish within two metres."""
    def rate(_, x):
        return math.sin(x[1]), feedback_curvature(x[0], x[1], 0.0, SETTINGS) / math.cos(x[1])

    end = solve_ivp(rate, (0.0, 2.0), start, rtol=1e-8).y[:, -1]
    assert np.abs(end).max() < 2e-3
