"""Rho over time: overdamped when slow, oscillating when fast; full dynamics against the plant."""

import dataclasses
import math

from helpers.plant_reference import ramp_robot
from helpers.study_outcomes import by_figure, numbers, outcome_of, values_of
import numpy as np
from push_model.dynamics import State
from push_model.geometry import Pose
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
import pytest
from scipy.integrate import solve_ivp
from studies.analysis.pushing_location import pushing_location
from studies.analysis.stability import free_response, LinearMotion
from studies.analysis.time_integration import integrate, straight_push
from studies.chapter2.rolling import rho_over_time

STUDIES = by_figure(rho_over_time)
SPEEDS = {'2.15': 0.5, '2.16': 1.5, '2.17': 2.5}


def found(figure, **overrides):
    """Compute a figure, some of its values overridden; return table and findings."""
    outcome = outcome_of(STUDIES[figure], **overrides)
    return outcome.tables['rho'], numbers(outcome)


def test_overdamped_at_half_a_metre_per_second():
    table, findings = found('2.15')
    assert findings['ratio'] > 1.0
    assert findings['overshoot'] < 1e-6 and findings['frequency'] == 0.0
    assert (np.diff(table['rho_rad']) < 1e-9).all()
    assert abs(table['rho_rad'][-1] - findings['rest']) < 0.05 * 0.1


@pytest.mark.parametrize('figure', ['2.16', '2.17'])
def test_oscillating_when_fast(figure):
    """Nearer to the linear motion the smaller the deviation."""
    _, findings = found(figure, initial_deviation=0.005)
    ratio = findings['ratio']
    assert ratio == pytest.approx(found('2.15')[1]['ratio'] * 0.5 / SPEEDS[figure])
    assert findings['frequency'] == pytest.approx(findings['linear_frequency'], rel=0.03)
    assert findings['overshoot'] == pytest.approx(
        math.exp(-math.pi * ratio / math.sqrt(1.0 - ratio ** 2)), rel=0.1)


def test_the_full_motion_tends_to_the_linear_one_for_small_disturbances():
    """What they differ by falls faster than the disturbance."""
    for figure in STUDIES:
        differ = []
        for start in (0.1, 0.01):
            table, _ = found(figure, initial_deviation=start)
            differ.append(np.abs(table['rho_rad'] - table['linear_rho_rad']).max() / start)
        assert differ[1] < 0.2 * differ[0] < 0.2 * 0.3


def test_the_speed_alone_makes_the_difference():
    table, findings = found('2.15', speed=2.5)
    assert table['rho_rad'] == pytest.approx(found('2.17')[0]['rho_rad'])
    assert findings['overshoot'] > 0.4
    heavy = found('2.17', mass=9.0)[0]['rho_rad']
    assert heavy == pytest.approx(found('2.17')[0]['rho_rad'], abs=1e-6)
    assert found('2.16', friction_coefficient=0.8)[1]['overshoot'] < 0.1


@pytest.mark.parametrize('figure', STUDIES)
def test_the_plant_moves_alike_and_its_contact_holds(figure):
    """From its state just after it has come up to speed, with the friction of the study."""
    values = values_of(STUDIES[figure])
    obj, radius = rho_over_time.pushed_object(values), values.robot_radius
    location = pushing_location(obj, rho_over_time.BEHIND, radius)
    rho = found(figure)[1]['rest'] + values.initial_deviation
    start = rho_over_time.released_state(obj, location, rho, values.speed)
    x, y = Pose(*start[:3]).transform((start.c_x, start.c_y))
    robot = dataclasses.replace(ramp_robot(radius), max_acceleration=10.0)
    plant = Plant(obj, robot, Pose(*start[:3]),
                  Pose(x - radius * math.cos(start.gamma), y - radius * math.sin(start.gamma),
                       0.0), 5e-4)
    plant.advance(values.speed / 10.0 + 0.01, Twist(values.speed, 0.0, 0.0))
    truth = plant.truth(0.0)
    local = Pose(*truth.object_pose).inverse().transform(truth.contact_point)
    begin = State(*truth.object_pose, truth.object_twist.omega, truth.normal, *local)
    assert abs(begin.omega) > 1e-3
    times = np.linspace(0.0, 4.0, 41)
    _, states = integrate(obj, location.rolling, straight_push(values.speed, 0.0), begin, times)
    for state in states[1:]:
        plant.advance(0.1, Twist(values.speed, 0.0, 0.0))
        assert plant.mode is ContactMode.STICK
        assert plant.object_pose.theta == pytest.approx(state[2], abs=5e-4)


def test_a_contact_that_would_slide_is_refused():
    with pytest.raises(ValueError, match='contact_friction: got 0.2, with which the contact sli'):
        found('2.15', contact_friction=0.2)


@pytest.mark.parametrize('inertia, damping, stiffness', [
    (0.1, 0.05, 0.8), (0.1, 2.0, 0.8), (0.2, 0.8, 0.8), (0.1, 0.3, -0.5), (0.1, 0.3, 0.0),
    (1e-4, 100.0, 0.5)])
def test_free_response_is_the_linear_motion_integrated(inertia, damping, stiffness):
    """Swinging, creeping, at the border, growing, indifferent, stiff."""
    times = np.linspace(0.0, 5.0, 21)
    run = solve_ivp(lambda _, y: [y[1], -(damping * y[1] + stiffness * y[0]) / inertia],
                    (0.0, 5.0), [1.0, 0.0], method='Radau', t_eval=times, rtol=1e-9, atol=1e-11)
    shares = free_response(LinearMotion(inertia, damping, stiffness), times)
    assert shares == pytest.approx(run.y[0], rel=1e-6, abs=1e-7)
