"""The package of the node for Nav2's behavior trees: its files agree with each other."""

import re
from xml.etree import ElementTree

from catkin_pkg.package import parse_package
from catkin_pkg.topological_order import topological_order
from helpers.architecture import ROOT
import pytest

FOLDER = ROOT / 'push_control_nav2'
MODEL = FOLDER / 'push_object_tree_nodes.xml'
TREES = sorted((FOLDER / 'behavior_trees').glob('*.xml'))
HEADER = (FOLDER / 'include' / FOLDER.name / 'push_object_action.hpp').read_text()
ACTION = (ROOT / 'push_control_msgs' / 'action' / 'PushObject.action').read_text()
# Ports that nodes of Nav2 have, beside the fields of the action.
OF_NAV2 = {'server_name', 'server_timeout', 'cancel_timeout'}
# Fields of the result whose ports have the names that Nav2 gives them.
OF_RESULT = {'error_code': 'error_code_id'}


def section(index):
    """Return the lines of a part of the action without comments: goal, result or feedback."""
    lines = ACTION.split('---\n')[index].splitlines()
    return [line.partition('#')[0].strip() for line in lines]


def fields(index):
    """List the names of the fields of a part of the action."""
    return {line.split()[1] for line in section(index) if line and '=' not in line}


def constants():
    """Return the error codes of the action by their names."""
    return {name: int(code) for line in section(1) if '=' in line
            for name, code in [line.split()[1].split('=')]}


def ports_of_code(direction):
    """List ports that the node declares: Input or Output."""
    declared = re.findall(rf'BT::{direction}Port<.+>\(\s*"(\w+)"', HEADER)
    assert len(declared) == len(set(declared))
    return set(declared)


def ports_of_model(direction):
    """List ports of the model for Groot: input or output."""
    return {port.get('name') for port in ElementTree.parse(MODEL).iter(f'{direction}_port')}


def test_its_manifest_fits_the_package_beside_it():
    """ROS tools read it without a warning; version and licence are those of push_control."""
    warnings = []
    manifest = parse_package(str(FOLDER), warnings=warnings)
    assert warnings == []
    assert manifest.get_build_type() == 'ament_cmake'
    assert manifest.version == parse_package(str(ROOT)).version
    assert (FOLDER / 'LICENSE').read_text() == (ROOT / 'LICENSE').read_text()


def test_each_field_of_the_action_is_a_port():
    """Goal fields are inputs and result fields are outputs, in the code and in the model."""
    inputs = fields(0)
    outputs = {OF_RESULT.get(name, name) for name in fields(1)}
    assert ports_of_code('Input') | OF_NAV2 == inputs | OF_NAV2
    assert ports_of_code('Output') == outputs
    assert ports_of_model('input') == inputs | OF_NAV2
    assert ports_of_model('output') == outputs


@pytest.mark.parametrize('path', TREES, ids=lambda path: path.stem)
def test_a_tree_refers_to_what_there_is(path):
    """Ports of PushObject and error codes are known; subtrees would have no ROS node."""
    tree = ElementTree.parse(path).getroot()
    assert tree.get('BTCPP_format') == '4'
    main, = tree.iter('BehaviorTree')
    assert tree.get('main_tree_to_execute') == main.get('ID')
    assert not list(tree.iter('SubTree'))
    pushes = list(tree.iter('PushObject'))
    assert pushes
    for push in pushes:
        ports = ports_of_model('input') | ports_of_model('output') | {'name'}
        assert set(push.attrib) <= ports
    for check in tree.iter('AreErrorCodesPresent'):
        codes = {int(code) for code in check.get('error_codes_to_check').split(';')}
        assert codes <= set(constants().values())


def test_a_workspace_has_all_three_packages(tmp_path):
    """The packages within this one are linked beside it, as the docs say; messages come first."""
    for folder in (ROOT, FOLDER, ROOT / 'push_control_msgs'):
        (tmp_path / folder.name).symlink_to(folder)
    order = [package.name for _, package in topological_order(str(tmp_path))]
    assert sorted(order) == ['push_control', 'push_control_msgs', 'push_control_nav2']
    assert order.index('push_control_msgs') < order.index('push_control_nav2')
