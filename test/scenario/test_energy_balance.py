"""Contact wrench, friction at the supports and energy, as every simulation tells them."""

import dataclasses

import numpy as np
from push_dynamics.floor import FloorPatch
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
from push_scenario.simulation.loop import simulate
from push_sim_node.disturbance import FrictionChange
import pytest
from scipy.integrate import trapezoid

pytestmark = pytest.mark.physics


@pytest.mark.parametrize('name, disturbances', [
    ('straight_push', {}), ('holonomic_face', {}),
    ('corner_push_mismatch', {'friction_changes': (FrictionChange(3.0, 5.0, 0.5, 1),),
                              'floor_patches': (FloorPatch(1.0, 0.2, 0.5, 0.5, 0.7),)})])
def test_work_is_kinetic_energy_and_losses_over_a_whole_scenario(name, disturbances):
    scenario = read_scenario(find_scenario(name))
    tape = simulate(dataclasses.replace(scenario, simulation=dataclasses.replace(
        scenario.simulation, **disturbances))).tape
    work, kinetic, *losses = (tape[f'energy_{part}'] for part in (
        'work', 'kinetic', 'support_loss', 'contact_loss', 'impact_loss', 'integration_loss'))
    assert work[-1] > 5.0
    assert work == pytest.approx(kinetic + sum(losses), rel=1e-9, abs=1e-12)
    for loss in losses:
        assert np.diff(loss).min() >= -1e-5 * work[-1]
    # Once more from the forces and velocities of the tape.
    supports, taken = scenario.true_object.supports, np.zeros(len(tape))
    turned = np.exp(1j * tape['object_theta'])
    for i, foot in enumerate(supports):
        velocity = (tape['object_v_x'] + 1j * tape['object_v_y']
                    + 1j * tape['object_omega'] * turned * complex(foot.x, foot.y))
        force = tape[f'support_{i}_x'] + 1j * tape[f'support_{i}_y']
        taken -= (force * velocity.conjugate()).real
    assert trapezoid(taken, tape['time']) == pytest.approx(losses[0][-1], rel=0.01)
    normal = np.exp(1j * tape['normal'])
    arm = (tape['contact_x'] - tape['robot_x']) + 1j * (tape['contact_y'] - tape['robot_y'])
    surface = ((tape['robot_v_x'] + 1j * tape['robot_v_y']) * np.exp(1j * tape['robot_theta'])
               + 1j * tape['robot_omega'] * arm)
    given = ((tape['force_n'] + 1j * tape['force_t']) * normal * surface.conjugate()).real
    assert trapezoid(given, tape['time']) == pytest.approx(work[-1], rel=0.02)
