"""Load transfer in the model: wheelbase, centre of friction, tipping."""

import dataclasses
import math

from helpers.objects import bin_, box
import numpy as np
from push_model.files.data import config_file
from push_model.files.parameter_files import read_object
from push_model.friction import (
    check_tipping, friction_center, load_gradients, LoadTransfer, SlidingSupport, tipping_height,
    transferred_capacities,
)
from push_model.parameters import PushedObject, Support
from push_model.quasi_static import (
    compare_yaw_rates, pushed_friction_center, quasi_static_yaw_rate, sliding_rows, straight_slide,
    vehicle,
)
import pytest
from scipy.optimize import linprog

pytestmark = pytest.mark.physics
MID_FACE = (-0.2, 0.0)
UNEVEN = {'friction': (0.2, 0.4, 0.3, 0.25), 'center_of_mass': (0.02, -0.03)}
FIVE_FEET = PushedObject(2.0, supports=(
    Support(-0.2, -0.1, 0.3), Support(0.1, -0.2, 0.5), Support(0.2, 0.1, 0.2),
    Support(-0.05, 0.2, 0.4), Support(0.0, 0.0, 0.6)), radius=0.25, center_of_mass=(0.03, -0.02))


@pytest.mark.parametrize('height', [0.0, 0.05, 0.1, 0.2])
def test_wheelbase_of_like_supports_is_the_closed_form(height):
    shift = 0.3 * height
    assert vehicle(box(contact_height=height), MID_FACE).wheelbase == pytest.approx(
        0.2 + shift + (0.04 - shift ** 2) / 0.2)


@pytest.mark.parametrize('obj, point', [
    (box(**UNEVEN, contact_height=0.2), MID_FACE),
    (box(**UNEVEN, contact_height=0.3), (-0.2, 0.1)),
    (bin_(contact_height=0.15), (-0.2, 0.0)),
    (dataclasses.replace(FIVE_FEET, contact_height=0.2), (-0.1, -0.2))])
def test_vehicle_is_the_slow_push_on_the_supports_near_straight(obj, point):
    """Whatever the supports: the rotation vanishes towards the centre, and grows with 1 / L."""
    view = vehicle(obj, point)
    flat = dataclasses.replace(obj, contact_height=0.0)
    assert abs(view.wheelbase / vehicle(flat, point).wheelbase - 1.0) > 0.02
    rates = [quasi_static_yaw_rate(obj, point, math.cos(view.angle + alpha),
                                   math.sin(view.angle + alpha)) for alpha in (-1e-5, 0.0, 1e-5)]
    assert rates[1] == pytest.approx(0.0, abs=1e-9)
    assert rates[0] - rates[2] == pytest.approx(2e-5 / view.wheelbase, rel=1e-6)


@pytest.mark.parametrize('angle', [-2.0, 0.3, 1.1])
def test_supports_that_slide_in_one_direction_have_the_capacities_of_the_general_law(angle):
    """The closed form of a common direction of sliding, against the two linear equations."""
    obj = dataclasses.replace(FIVE_FEET, contact_height=0.15)
    transfer = LoadTransfer.of(obj)
    along = np.array([math.cos(angle), math.sin(angle)])
    capacities = np.array(transferred_capacities(transfer, (
        SlidingSupport(capacity, *support, *along)
        for capacity, support in zip(obj.capacities, transfer.supports))))
    places = np.array([(support.x, support.y) for support in obj.supports])
    center = capacities @ places / capacities.sum()
    found = straight_slide(obj.contact_height, sliding_rows(obj), angle)
    assert found.center == pytest.approx(center)
    assert found.c_squared == pytest.approx(
        capacities @ ((places - center) @ along) ** 2 / capacities.sum())


def test_friction_center_moves_ahead_on_like_supports_and_aside_on_unlike_ones():
    assert pushed_friction_center(box(contact_height=0.2), MID_FACE) == pytest.approx((0.06, 0.0))
    # The rear is even, the front rougher on the right: weight that moves ahead moves F to there.
    uneven = box(friction=(0.3, 0.4, 0.2, 0.3), contact_height=0.2)
    assert pushed_friction_center(uneven, MID_FACE)[1] < friction_center(uneven)[1] - 5e-3


def test_floor_height_is_the_limit():
    for obj in (box(**UNEVEN), bin_()):
        low = dataclasses.replace(obj, contact_height=1e-9, center_of_mass_height=1e-9)
        assert vehicle(low, MID_FACE).wheelbase == pytest.approx(
            vehicle(obj, MID_FACE).wheelbase, rel=1e-7)
        for one, other in zip(*(compare_yaw_rates(o, MID_FACE, (-0.4, 0.1, 0.8))
                                for o in (low, obj))):
            assert one == pytest.approx(other, abs=1e-7)


def test_gradients_balance_force_and_moment():
    for obj in (box(**UNEVEN), bin_(), FIVE_FEET):
        gradients = np.array(load_gradients(obj))
        places = np.array([(support.x, support.y) for support in obj.supports])
        assert gradients.sum(axis=0) == pytest.approx([0.0, 0.0], abs=1e-12)
        assert gradients.T @ places == pytest.approx(np.eye(2), abs=1e-12)


def stands(obj, height, direction):
    """Say whether some loads that do not pull balance a slow push in a direction."""
    push = np.array([math.cos(direction), math.sin(direction)])
    places = np.array([(support.x, support.y) for support in obj.supports]) - obj.center_of_mass
    friction = np.array([support.friction_coefficient for support in obj.supports])
    balance = np.vstack([np.ones(len(places)), (places - height * np.outer(friction, push)).T])
    return linprog(np.zeros(len(places)), A_eq=balance, b_eq=[1.0, 0.0, 0.0]).status == 0


@pytest.mark.parametrize('obj', [box(**UNEVEN), bin_(), FIVE_FEET],
                         ids=['box', 'bin', 'five feet'])
def test_tipping_height_is_where_no_loads_balance_a_push_any_more(obj):
    height = tipping_height(obj)
    directions = np.linspace(0.0, 2.0 * math.pi, 72, endpoint=False)
    assert all(stands(obj, 0.99 * height, direction) for direction in directions)
    assert not all(stands(obj, 1.01 * height, direction) for direction in directions)


def test_objects_that_tip_are_refused_with_the_height():
    bin_on_rubber = read_object(config_file('objects/bin.yaml'))
    check_tipping(dataclasses.replace(bin_on_rubber, contact_height=0.177))
    with pytest.raises(ValueError, match=r'contact_height: got 0\.19 m, expected below 0\.177 m'):
        check_tipping(dataclasses.replace(bin_on_rubber, contact_height=0.19))
    assert tipping_height(box(friction=(0.0,) * 4)) == math.inf
