"""The objects that come with the package can be named by scenarios and pushed."""

import math

import numpy as np
from push_model.contact import contact_point, find_contact
from push_model.files.data import share_directory
from push_model.files.parameter_files import read_object
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import GRAVITY, RoundRobot
from push_model.signals import Twist
from push_scenario.definition.loader import scenario_from_text
from push_sim_node.plant import Plant
import pytest

pytestmark = pytest.mark.physics
FILES = sorted((share_directory() / 'config' / 'objects').glob('*.yaml'))
ORIGIN = Pose(0.0, 0.0, 0.0)
SCENARIO = """
description: Push it.
object: {{file: {name}}}
true_object: {{mass: 2.5}}
robot: {{file: holonomic_017.yaml}}
start: {{robot: {{x: -2}}}}
goal: {{x: 1}}
"""


@pytest.mark.parametrize('path', FILES, ids=lambda path: path.stem)
def test_object_file_makes_an_object_that_stands(path):
    obj = read_object(path)
    loads = np.array(obj.loads)
    places = np.array([(foot.x, foot.y) for foot in obj.supports])
    assert loads.sum() == pytest.approx(obj.mass * GRAVITY, rel=1e-9)
    assert loads @ places / loads.sum() == pytest.approx(np.array(obj.center_of_mass), abs=1e-4)
    # The gyration radius of what lies within the outline.
    reach = max([obj.radius] + [math.hypot(x, y) for x, y in obj.outline])
    assert 0.3 * reach < math.sqrt(obj.inertia / obj.mass) < reach
    for x, y in (*places, friction_center(obj)):
        assert find_contact(obj, ORIGIN, (x, y), 0.0)[2] < 0.0


@pytest.mark.parametrize('path', FILES, ids=lambda path: path.stem)
def test_scenario_names_an_object_file(path):
    scenario = scenario_from_text(SCENARIO.format(name=path.name), 'case')
    assert scenario.object == read_object(path)
    assert scenario.true_object.mass == 2.5
    assert scenario.true_object.outline == scenario.object.outline
    given = '\ninertia:' in path.read_text()
    ratio = scenario.true_object.inertia / scenario.object.inertia
    assert ratio == pytest.approx(1.0 if given else 2.5 / scenario.object.mass)


@pytest.mark.parametrize('path', FILES, ids=lambda path: path.stem)
def test_object_is_pushed_about_its_friction_centre(path):
    """Straight ahead towards the friction centre it hardly turns, to the left of it rightwards."""
    obj = read_object(path)
    f_x, f_y = friction_center(obj)
    turned = []
    for aside in (0.0, 0.08):
        contact, gamma, gap = find_contact(obj, ORIGIN, (-3.0, f_y + aside), 0.2)
        if contact.kind == 'round':
            y = f_y + aside
            start = Pose(-math.sqrt((obj.radius + 0.2) ** 2 - y * y), y, 0.0)
        else:
            start = Pose(contact_point(obj, contact)[0] - 0.2, f_y + aside, 0.0)
            assert gamma == pytest.approx(0.0)
        plant = Plant(obj, RoundRobot(0.2, 'holonomic'), ORIGIN, start)
        plant.advance(1.5, Twist(0.1, 0.0, 0.0))
        assert plant.object_pose.x > 0.05
        turned.append(plant.object_pose.theta)
    assert abs(turned[0]) < 0.03 and turned[1] < -0.03
