"""Parameter files of robots: they name only what the nodes have, and keep what they promise."""

from docs.tools.reference import GROUPS
from geometry_msgs.msg import PolygonStamped
import numpy as np
from push_control.settings import ControlSettings
from push_model.files.data import config_file
from push_model.files.flat_values import from_parameter_values, parameter_specs
from push_model.parameters import RoundRobot
from push_navigation.settings import DriveSettings
from push_planner.settings import PlannerSettings
from push_ros.node_settings import Frames, TrackerOptions
from push_ros.topics import CONTROLLER, PLANNER, TOPICS, TRACKER
from push_scenario.dds.launch_parameters import launch_parameters
from push_tracker.settings import TrackerSettings
import pytest
import yaml

FOLDER = config_file('bringup/create3.yaml').parent
# Files for nodes of others, and for the tracker alone.
FOREIGN, TAGS = {'create3_motion_control', 'nav2'}, 'tags'
FILES = sorted({path.stem for path in FOLDER.glob('*.yaml')} - FOREIGN - {TAGS})
# What a reader is told to start with [m/s].
FIRST_SPEED = 0.05


def given(name, node):
    """Return the parameters that a node gets from a file."""
    sections = launch_parameters(FOLDER / f'{name}.yaml')
    return {**sections['/**'], **sections.get(f'/**/{node}', {})}


@pytest.mark.parametrize('name, node', [
    *[(name, node) for name in FILES for node in (PLANNER, CONTROLLER)], (TAGS, TRACKER)])
def test_files_have_only_parameters_that_their_nodes_have(name, node):
    """And values that pass every check."""
    values = given(name, node)
    known = {spec.name for prefix, cls in GROUPS[node] for spec in parameter_specs(cls, prefix)}
    assert set(values) <= known
    for prefix, cls in GROUPS[node]:
        from_parameter_values(cls, values, prefix)


def test_the_tags_are_on_the_object_and_in_the_frame_of_the_robot():
    """Upright ones look outwards, and the z axis of one on top points up."""
    values = given(TAGS, TRACKER)
    top, front = from_parameter_values(TrackerSettings, values, 'tracker.').tags
    assert np.allclose(top.pose.rotate((0.0, 0.0, 1.0)), (0.0, 0.0, 1.0), atol=1e-4)
    assert np.allclose(front.pose.rotate((0.0, 0.0, 1.0)), (1.0, 0.0, 0.0), atol=1e-4)
    world = from_parameter_values(TrackerOptions, values, '').world_frame
    assert {given(name, CONTROLLER)['world_frame'] for name in FILES} == {world}


@pytest.mark.parametrize('name', FILES)
def test_the_first_push_is_slow_and_waits(name):
    planner, controller = given(name, PLANNER), given(name, CONTROLLER)
    settings = from_parameter_values(PlannerSettings, planner, 'planner.')
    assert settings.pushing_speed == settings.straight_speed == FIRST_SPEED
    assert controller['wait_for_start'] and controller['task']
    # Poses and odometry at 20 Hz, three of them lost.
    control = from_parameter_values(ControlSettings, controller, 'control.')
    assert min(control.pose_timeout, control.odometry_timeout) > 4 / 20


def test_a_create3_with_its_reverse_limit_goes_back_by_a_decimetre():
    """Its retreat and the beginning of the next path together; half as much is left to stop."""
    values = given('create3_reverse_limit', CONTROLLER)
    drive = from_parameter_values(DriveSettings, values, 'drive.')
    assert drive.retreat_distance + drive.reverse_limit <= 0.1
    assert from_parameter_values(DriveSettings, given('create3_reverse_limit', PLANNER),
                                 'drive.') == drive


def test_the_base_of_a_create3_ignores_touches_and_still_sees_cliffs():
    sections = yaml.safe_load((FOLDER / 'create3_motion_control.yaml').read_text())
    values = sections['/**']['ros__parameters']
    off = {name for name, value in values.items() if value is False}
    assert off == {f'reflexes.REFLEX_{name}' for name in ('BUMP', 'PANIC', 'PROXIMITY_SLOWDOWN',
                                                          'STUCK')}
    assert values['safety_override'] == 'backup_only'


def nav2_nodes():
    """Return the parameters of the nodes beside Nav2."""
    return {name: section['ros__parameters'] for name, section in
            yaml.safe_load((FOLDER / 'nav2.yaml').read_text()).items()}


def test_the_collision_monitor_is_given_what_the_nodes_publish():
    """Our footprint, in its frame; what it lets pass goes to the multiplexer."""
    nodes = nav2_nodes()
    monitor = nodes['collision_monitor_push']
    topic = TOPICS[monitor['ahead']['footprint_topic']]
    assert topic.publishers == (CONTROLLER,) and topic.type is PolygonStamped
    frames = Frames()
    assert monitor['base_frame_id'] == frames.base_frame
    assert monitor['odom_frame_id'] == frames.world_frame
    assert monitor['cmd_vel_out_topic'] == nodes['twist_mux']['topics']['push']['topic']
    assert monitor['enable_stamped_cmd_vel'] == nodes['twist_mux']['use_stamped'] \
        == nodes['velocity_smoother_push']['enable_stamped_cmd_vel']
    for name in monitor['polygons']:
        assert set(monitor[name]['sources_names']) <= set(monitor['observation_sources'])
    # A source that nobody publishes would stop the robot.
    assert monitor['ahead']['enabled'] is monitor['above']['enabled'] is False


def test_what_stands_between_us_and_the_base_changes_no_plan():
    """The smoother limits nothing that the robot of the Create 3 can; pushes precede Nav2."""
    nodes = nav2_nodes()
    robot = from_parameter_values(RoundRobot, given('create3', CONTROLLER), 'robot.')
    smoother = nodes['velocity_smoother_push']
    assert np.all(np.abs([smoother['max_velocity'], smoother['min_velocity']])
                  >= [robot.max_speed, 0.0, robot.max_yaw_rate])
    assert np.all(np.abs([smoother['max_accel'], smoother['max_decel']])
                  >= [robot.max_acceleration, 0.0, robot.max_yaw_acceleration])
    priority = {name: entry['priority'] for name, entry in nodes['twist_mux']['topics'].items()}
    assert priority['teleop'] > priority['push'] > priority['navigation']
    zone = nodes['collision_monitor_push']['behind']['backwards']
    points = np.array(yaml.safe_load(zone['points']))
    assert points[:, 0].max() <= 0.0 and np.abs(points).max() > robot.radius
    assert zone['linear_max'] < 0.0
