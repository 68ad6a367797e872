"""Whatever values parameters of a node have, it takes them or refuses them by name."""

import math

from helpers.fuzzing import hypothesis, NUMBERS, settings, st, STEPS
from push_control import controller_node
from push_model.files.flat_values import from_parameter_values, parameter_specs
from push_model.parameters import PushedObject, Support
from push_planner import planner_node
from push_sim_node import sim_node
from push_tracker import tracker_node
import pytest

NODES = {'planner': planner_node, 'controller': controller_node, 'sim': sim_node,
         'tracker': tracker_node}
# What must be given.
GIVEN = {'object.mass': 5.0, 'object.outline': [-0.2, -0.2, 0.2, -0.2, 0.2, 0.2, -0.2, 0.2],
         'object.supports.x': [0.0], 'object.supports.y': [0.0],
         'object.supports.friction_coefficient': [0.3], 'robot.radius': 0.17}
TEXTS = st.one_of(st.text(st.characters(exclude_categories=['Cs']), max_size=10),
                  st.sampled_from(['feedback', 'primitives', 'holonomic', 'odom', '/odom']))
INTEGERS = st.integers(-2 ** 63, 2 ** 63 - 1)
# All types of parameters that ROS has.
VALUES = st.one_of(st.booleans(), INTEGERS, NUMBERS, TEXTS, *(
    st.lists(items, max_size=8) for items in (st.booleans(), INTEGERS, NUMBERS, TEXTS)))


@pytest.mark.parametrize('name', NODES)
@settings(STEPS)
@hypothesis.given(data=st.data())
def test_parameters_are_taken_or_refused(name, data):
    """With the name of one of them."""
    sections = NODES[name].SECTIONS
    specs = [spec for prefix, cls in sections for spec in parameter_specs(cls, prefix)]
    changes = data.draw(st.dictionaries(st.sampled_from([spec.name for spec in specs]), VALUES,
                                        max_size=4))
    values = {**GIVEN, **changes}
    try:
        for prefix, cls in sections:
            from_parameter_values(cls, values, prefix)
    except ValueError as error:
        assert 'got' in str(error) and 'expected' in str(error)


@settings(STEPS)
@hypothesis.given(st.integers(3, 40), st.integers(1, 30), st.floats(0.01, 10.0),
                  st.floats(0.0, 1.0), NUMBERS)
@hypothesis.example(3, 5, 1.0, 1.0, 5e-324)
def test_objects_of_any_shape_are_objects_or_refused(count, feet, radius, squash, mass):
    """As numbers of a scan may have it."""
    ring = [(radius * math.cos(math.tau * i / count), squash * radius * math.sin(
        math.tau * i / count)) for i in range(count)]
    supports = tuple(Support(0.9 * radius * math.cos(i), 0.9 * squash * radius * math.sin(i), 0.3)
                     for i in range(feet))
    try:
        obj = PushedObject(mass=mass, outline=tuple(ring), supports=supports)
    except ValueError as error:
        assert str(error).startswith('PushedObject.')
        return
    assert sum(obj.loads) == pytest.approx(9.81 * mass)
    assert obj.inertia > 0.0 and min(obj.loads) >= 0.0
