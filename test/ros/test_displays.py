"""Views for RViz and Foxglove: they show what the nodes publish, and give what these expect."""

import json
import re

from push_model.files.data import config_file
from push_ros.conversions import markers
from push_ros.node_settings import Frames
from push_ros.topics import TOPICS
from push_view.page_file import page_source
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
import yaml

RVIZ = yaml.safe_load(config_file('push.rviz').read_text())['Visualization Manager']
FOXGLOVE = json.loads(config_file('foxglove.json').read_text())
# What the plugins of rviz_default_plugins draw or publish, as its plugins_description.xml says,
# and their properties besides those of every display.
DISPLAYS = {
    'Grid': (None, {'Cell Size', 'Color', 'Line Style', 'Normal Cell Count', 'Offset', 'Plane',
                    'Plane Cell Count', 'Reference Frame'}),
    'Map': ('nav_msgs/msg/OccupancyGrid', {'Color Scheme', 'Draw Behind', 'Use Timestamp'}),
    'MarkerArray': ('visualization_msgs/msg/MarkerArray', {'Namespaces'}),
    'Polygon': ('geometry_msgs/msg/PolygonStamped', {'Color'}),
    'Path': ('nav_msgs/msg/Path', {
        'Buffer Length', 'Color', 'Head Diameter', 'Head Length', 'Length', 'Line Style',
        'Line Width', 'Offset', 'Pose Color', 'Pose Style', 'Radius', 'Shaft Diameter',
        'Shaft Length'}),
    'Pose': ('geometry_msgs/msg/PoseStamped', {
        'Axes Length', 'Axes Radius', 'Color', 'Head Length', 'Head Radius', 'Shaft Length',
        'Shaft Radius', 'Shape'}),
}
COMMON = {'Alpha', 'Class', 'Enabled', 'Name', 'Topic', 'Value'}
TOOLS = {'SetGoal': 'geometry_msgs/msg/PoseStamped',
         'SetInitialPose': 'geometry_msgs/msg/PoseWithCovarianceStamped'}
DURABILITY = {'Volatile': DurabilityPolicy.VOLATILE,
              'Transient Local': DurabilityPolicy.TRANSIENT_LOCAL}
# What a 3D panel of Foxglove draws, and the settings of each; all have ``visible``.
SCENE = {
    'geometry_msgs/msg/PolygonStamped': {'color'},
    'geometry_msgs/msg/PoseStamped': {'type', 'axisScale', 'color'},
    'nav_msgs/msg/OccupancyGrid': set(),
    'nav_msgs/msg/Odometry': {'type', 'axisScale'},
    'nav_msgs/msg/Path': {'type', 'lineWidth', 'gradient'},
    'visualization_msgs/msg/MarkerArray': set(),
}
PUBLISHED = {'poseTopic': 'geometry_msgs/msg/PoseStamped',
             'poseEstimateTopic': 'geometry_msgs/msg/PoseWithCovarianceStamped'}
SHOWN_ELSEWHERE = {'DiagnosticSummary': 'diagnostic_msgs/msg/DiagnosticArray',
                   'RosOut': 'rcl_interfaces/msg/Log'}


def type_name(message_type):
    """Name a message type as ``ros2 topic list -t`` does."""
    package, folder = message_type.__module__.split('.')[:2]
    return f'{package}/{folder}/{message_type.__name__}'


# A namespace is that of RViz itself, so that its topics are relative; Foxglove has absolute ones.
TYPES = {**{f'/{name}': type_name(topic.message_type()) for name, topic in TOPICS.items()},
         '/rosout': type_name(Log)}


def panel(kind):
    """Return the configurations of the panels of one kind."""
    return [config for name, config in FOXGLOVE['configById'].items()
            if name.split('!')[0] == kind]


def leaves(layout):
    """List the panels of a layout, which divides the screen again and again."""
    if isinstance(layout, str):
        return [layout]
    assert layout['direction'] in ('row', 'column') and 0 < layout['splitPercentage'] < 100
    return leaves(layout['first']) + leaves(layout['second'])


def field_type(name, path):
    """Follow a path of fields into a message type; return the type of the last one."""
    kind = TOPICS[name].message_type()
    for field in path[:-1]:
        kind = type(getattr(kind(), field))
    return kind.get_fields_and_field_types()[path[-1]]


def test_rviz_shows_each_topic_with_its_type_and_qos():
    """A display that asks for more than is offered would stay empty without a word."""
    for display in RVIZ['Displays']:
        kind, properties = DISPLAYS[display['Class'].removeprefix('rviz_default_plugins/')]
        assert display['Enabled'] and set(display) - COMMON <= properties
        if kind is None:
            continue
        topic = display['Topic']
        name = topic['Value']
        assert TYPES[f'/{name}'] == kind
        offered = TOPICS[name].publish_qos
        assert DURABILITY[topic['Durability Policy']] is offered.durability
        assert topic['Reliability Policy'] == 'Reliable'
        assert offered.reliability is ReliabilityPolicy.RELIABLE


def test_rviz_gives_goals_and_poses_to_start_from():
    tools = {tool['Class'].removeprefix('rviz_default_plugins/'): tool['Topic']
             for tool in RVIZ['Tools'] if 'Topic' in tool}
    assert {name: TYPES['/' + topic['Value']] for name, topic in tools.items()} == TOOLS
    for topic in tools.values():
        assert TOPICS[topic['Value']].subscribers
        assert DURABILITY[topic['Durability Policy']] is DurabilityPolicy.VOLATILE


def test_both_views_stand_in_the_world_frame():
    scene, = panel('3D')
    world = Frames().world_frame
    assert RVIZ['Global Options']['Fixed Frame'] == world
    assert scene['fixedFrame'] == scene['followTf'] == world


def test_foxglove_shows_each_topic_with_its_type():
    scene, = panel('3D')
    for name, settings in scene['topics'].items():
        assert set(settings) <= {'visible'} | SCENE[TYPES[name]]
        assert settings['visible']
    assert {key: TYPES[scene['publish'][key]] for key in PUBLISHED} == PUBLISHED
    assert {kind: TYPES[config['topicToRender']] for kind in SHOWN_ELSEWHERE
            for config in panel(kind)} == SHOWN_ELSEWHERE


def test_foxglove_plots_numbers_of_messages():
    lines = [path['value'] for plot in panel('Plot') for path in plot['paths']]
    assert lines
    for line in lines:
        name, *path = line.removeprefix('/').split('.')
        assert field_type(name, path) == 'double'


def test_every_panel_has_its_place():
    assert sorted(leaves(FOXGLOVE['layout'])) == sorted(FOXGLOVE['configById'])
    assert {name.split('!')[0] for name in FOXGLOVE['configById']} == {
        '3D', 'Plot', *SHOWN_ELSEWHERE}
    assert {'globalVariables', 'userNodes', 'playbackConfig'} < set(FOXGLOVE)


def test_everything_has_the_color_that_it_has_on_the_page():
    """In markers, RViz and Foxglove: goal, path of the plan, robot and what else is drawn."""
    light = page_source('page.css').partition('@media')[0]
    page = dict(re.findall(r'--([a-z]+): (#[0-9a-f]{6});', light))
    for name in ('object', 'goal', 'robot', 'believed', 'force', 'cone', 'plan', 'ink'):
        color = getattr(markers, name.upper())
        assert '#' + ''.join(f'{round(255 * value):02x}' for value in color) == page[name]
    scene, = panel('3D')
    topics = scene['topics']
    assert topics['/goal_pose']['color'] == page['goal'] + 'ff'
    assert topics['/footprint']['color'][:7] == page['robot']
    assert set(topics['/planned_path']['gradient']) == {page['plan'] + 'ff'}
    displayed = {display['Name']: display.get('Color') for display in RVIZ['Displays']}
    for name, title in (('goal', 'Goal'), ('robot', 'Footprint'), ('plan', 'Planned path')):
        numbers = [str(int(page[name][i:i + 2], 16)) for i in (1, 3, 5)]
        assert displayed[title] == '; '.join(numbers)
