"""
Start planner and controller for a real robot.

The robot and a tracker provide ``odom`` and ``object_pose``, and the robot subscribes ``cmd_vel``.
With ``wait_for_start:=true`` the robot moves only after a call of ``controller/start``. Arguments
that are left empty leave their parameters as ``params_file`` has them.
"""

from collections.abc import Mapping
from pathlib import Path
import shutil
from typing import Any

from ament_index_python.packages import get_package_prefix, PackageNotFoundError
from launch import Action, LaunchContext, LaunchDescription
from launch.actions import (
    DeclareLaunchArgument, ExecuteProcess, LogInfo, OpaqueFunction, Shutdown,
)
from launch.logging import launch_config
from launch.substitutions import PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare
from push_ros.push_interfaces import STATUS
from push_ros.security_policy import enclave_of
from push_ros.topics import TOPICS as ALL_TOPICS
from push_scenario.dds.launch_parameters import launch_parameters, switch, write_parameters

CONFIG = PathJoinSubstitution([FindPackageShare('push_control'), 'config'])
# Launch arguments, texts by name.
Arguments = Mapping[str, str]
# Arguments that name topics, and what these carry.
TOPICS = {
    'odom': 'nav_msgs/Odometry of the robot',
    'robot_pose': 'geometry_msgs/PoseStamped of a rigid body on the robot, for mocap',
    'object_pose': 'geometry_msgs/PoseStamped or PoseWithCovarianceStamped of the object',
    'scan': 'sensor_msgs/LaserScan of the robot, with place.source scan',
    'place': 'geometry_msgs/PoseWithCovarianceStamped of the robot, as amcl_pose, with '
             'place.source place',
    'goal_pose': 'geometry_msgs/PoseStamped, goal pose of the object',
    'cmd_vel': 'velocity command for the robot',
}
# Choices of arguments that are on or off, as people write them in YAML and in Python; and of those
# that leave a parameter as it is where they are empty.
BOOLEAN = ['true', 'false', 'True', 'False']
SWITCH = ['', *BOOLEAN]
# Name: (default, choices, description).
ARGUMENTS = {
    'namespace': ('', None, 'namespace of all nodes, topics and services, tf included'),
    'params_file': (PathJoinSubstitution([CONFIG, 'push.yaml']), None,
                    'parameters of the nodes: measure your object and robot first'),
    'use_sim_time': ('false', BOOLEAN, 'take the time from the topic clock'),
    'log_level': ('info', ['debug', 'info', 'warn', 'error', 'fatal'], 'of the nodes'),
    'object': ('', None, 'object in place of that of params_file: name in config/objects, or a '
               'file'),
    'robot': ('', None, 'robot in place of that of params_file: name in config/robots, or a file'),
    'task': ('', SWITCH, 'drive around the object and push as often as necessary; else push once '
             'from where the robot stands'),
    'map': ('', None, 'YAML file of a map for nav2_map_server, which is then started; without it '
            'any map that is published is used'),
    'map_topic': ('map', None, 'nav_msgs/OccupancyGrid of the obstacles in a task'),
    'map_frame': ('map', None, 'frame in which that file has its origin'),
    'clock': ('/clock', None, 'topic of the clock, where use_sim_time is true'),
    'tracker': ('', None, 'file of parameters for tf_tracker, which is then started: it makes '
                'object_pose of transforms of tags, or of motion capture'),
    'mocap': ('', None, 'file of parameters for mocap_odometry, which is then started: it makes '
              'odom of the poses of a rigid body on the robot'),
    'object_pose_with_covariance': ('', SWITCH, 'object_pose is PoseWithCovarianceStamped, else '
                                    'PoseStamped; with tracker it is'),
    'tidy': ('false', BOOLEAN, 'start the node tidy, too, which serves push_objects; params_file '
             'states the objects'),
    'simulation': ('false', BOOLEAN,
                   'start the simulator in place of robot and tracker'),
    'simulator': ('sim', ['sim', 'mujoco_sim'],
                  'which simulator that is: the own one, or MuJoCo with wheels and camera'),
    'sensors': ('', None, 'sensors of the simulator: name in config/sensors, or file'),
    'autostart': ('', SWITCH, 'configure and activate planner and controller at once; else a '
                  'lifecycle manager does'),
    'wait_for_start': ('', SWITCH, 'push only after a call of the service controller/start'),
    'enable_stamped_cmd_vel': ('', SWITCH, 'command with TwistStamped, else with Twist'),
    'rviz': ('false', BOOLEAN, 'start RViz, where it is installed'),
    'record': ('', None, 'folder for a recording of all topics of the nodes; empty for none'),
    'respawn': ('false', BOOLEAN, 'start a node again that has ended; else all end'),
}
# Topic of the map with the objects in it, where ``tidy`` makes that of the map of ``map_topic``.
MAP_WITH_OBJECTS = 'map_with_objects'
# Time before a node is started again [s], chosen as that of Nav2.
RESPAWN_DELAY = 2.0


def generate_launch_description() -> LaunchDescription:
    """Describe the launch arguments, and the nodes to start."""
    return LaunchDescription([
        *[DeclareLaunchArgument(name, default_value=default, choices=choices, description=text)
          for name, (default, choices, text) in ARGUMENTS.items()],
        *[DeclareLaunchArgument(name, default_value=name, description=text)
          for name, text in TOPICS.items()],
        # Every mistake shows here, before anything is started.
        OpaqueFunction(function=make_nodes),
    ])


def make_nodes(context: LaunchContext) -> list[Action]:
    """
    Make the nodes for the arguments that were given.

    :param context: ``LaunchContext``.
    :return: actions.
    :raises ValueError: naming an argument, what came and what was expected.
    """
    given = context.launch_configurations
    sections = launch_parameters(given['params_file'], given['object'], given['robot'],
                                 given['sensors'])
    options = common_options(given)
    common = {**options, 'parameters': [write_parameters(sections, launch_config.log_dir)]}
    poses = object_poses(given)
    planner = switches(given, 'autostart')
    controller = switches(given, 'autostart', 'task', 'wait_for_start', 'enable_stamped_cmd_vel')
    if given['map']:
        controller['map_required'] = True
    return [
        *simulator(given, common), *tracker(given, options, poses), *mocap(given, options),
        push_node('planner', common, {**planner, **poses}),
        push_node('controller', common, {**controller, **poses}), *tidy(given, common, poses),
        *map_server(given),
        *recording(given), *rviz(given, common),
    ]


def common_options(given: Arguments) -> dict[str, Any]:
    """
    Make what all nodes have in common.

    :param given: arguments, texts by name.
    :return: keyword arguments of ``Node``, without ``parameters``.
    """
    respawn = switch('respawn', given['respawn'])
    remappings = [(name, given[name]) for name in TOPICS]
    # As in Nav2: every namespace has a tf of its own.
    remappings += [('/tf', 'tf'), ('/tf_static', 'tf_static'), ('/clock', given['clock'])]
    if switch('tidy', given['tidy']):
        remappings += [('room_map', given['map_topic']), ('map', MAP_WITH_OBJECTS)]
    else:
        remappings.append(('map', given['map_topic']))
    return {'namespace': given['namespace'], 'remappings': remappings, 'output': 'screen',
            'respawn': respawn, 'respawn_delay': RESPAWN_DELAY, 'log_level': given['log_level'],
            'use_sim_time': switch('use_sim_time', given['use_sim_time'])}


def switches(given: Arguments, *names: str) -> dict[str, bool | None]:
    """Read those of some arguments that were given."""
    return {name: switch(name, given[name]) for name in names if given[name]}


def push_node(executable: str, common: dict[str, Any], parameters: dict[str, Any],
              name: str = '') -> Node:
    """
    Make a node of this package.

    :param executable: its name.
    :param common: of ``common_options``, with ``parameters``.
    :param parameters: dict of those that take precedence.
    :param name: of the node; by default that of the executable behind ``push_``.
    """
    options = dict(common)
    name = name or f'push_{executable}'
    # Of this node alone: that of the middleware drowns everything.
    logger = '.'.join([*filter(None, options['namespace'].split('/')), name])
    level = f'{logger}:={options.pop("log_level")}'
    enclave = enclave_of(name, options['namespace'])
    own = {'use_sim_time': options.pop('use_sim_time'), **parameters}
    parameters = [*options.pop('parameters'), own]
    ending = {} if options['respawn'] else {'on_exit': Shutdown(reason=f'{executable} has ended')}
    return Node(package='push_control', executable=executable, name=name,
                parameters=parameters, ros_arguments=['--log-level', level, '--enclave', enclave],
                **options, **ending)


def simulator(given: Arguments, common: dict[str, Any]) -> list[Action]:
    """Make the simulator, which makes the time where the others take it from the clock."""
    if not switch('simulation', given['simulation']):
        return []
    parameters = {'autostart': True, 'use_sim_time': False,
                  'publish_clock': switch('use_sim_time', given['use_sim_time']),
                  **switches(given, 'enable_stamped_cmd_vel')}
    # Both have the parameters of one section.
    return [push_node(given['simulator'], common, parameters, name='push_sim')]


def object_poses(given: Arguments) -> dict[str, bool | None]:
    """
    Tell what object poses are, where that was given; those of the tracker have a covariance.

    :raises ValueError: where the simulator would publish others, or as well.
    """
    poses = switches(given, 'object_pose_with_covariance')
    if given['tracker']:
        poses = {'object_pose_with_covariance': True, **poses}
    if switch('simulation', given['simulation']):
        for name in ('tracker', 'mocap', 'object_pose_with_covariance'):
            if given[name] not in ('', 'false', 'False'):
                raise ValueError(f'{name}: got {given[name]!r} with the simulator, which '
                                 'publishes odom and object_pose itself, as PoseStamped; '
                                 'expected none')
    return poses


def tracker(given: Arguments, options: dict[str, Any], poses: dict[str, bool | None]
            ) -> list[Action]:
    """Make the tracker for a parameter file."""
    if not given['tracker']:
        return []
    sections = launch_parameters(given['tracker'], argument='tracker')
    file = write_parameters(sections, launch_config.log_dir)
    return [push_node('tf_tracker', {**options, 'parameters': [file]}, poses, name='push_tracker')]


def tidy(given: Arguments, common: dict[str, Any], poses: dict[str, bool | None]) -> list[Action]:
    """Make the node that brings several objects to their goals."""
    return [push_node('tidy', common, {**poses})] if switch('tidy', given['tidy']) else []


def mocap(given: Arguments, options: dict[str, Any]) -> list[Action]:
    """Make the odometry of motion capture for a parameter file."""
    if not given['mocap']:
        return []
    sections = launch_parameters(given['mocap'], argument='mocap')
    file = write_parameters(sections, launch_config.log_dir)
    return [push_node('mocap_odometry', {**options, 'parameters': [file]}, {},
                      name='mocap_odometry')]


def is_installed(package: str) -> bool:
    """Tell whether a ROS package is installed."""
    try:
        get_package_prefix(package)
    except PackageNotFoundError:
        return False
    return True


def map_server(given: Arguments) -> list[Action]:
    """Make the map server for a map file, and the node that activates it."""
    if not given['map']:
        return []
    for package in ('nav2_map_server', 'nav2_lifecycle_manager'):
        if not is_installed(package):
            raise ValueError(f'map: got {given["map"]!r} without {package}; expected that this '
                             'is installed, or a map on a topic')
    if not Path(given['map']).is_file():
        raise ValueError(f'map: got {given["map"]!r}, expected a file')
    use_sim_time = switch('use_sim_time', given['use_sim_time'])
    common = {'namespace': given['namespace'], 'output': 'screen',
              'remappings': [('map', given['map_topic']), ('/clock', given['clock'])]}
    return [
        Node(package='nav2_map_server', executable='map_server', name='map_server',
             parameters=[{'yaml_filename': given['map'], 'frame_id': given['map_frame'],
                          'use_sim_time': use_sim_time}], **common),
        Node(package='nav2_lifecycle_manager', executable='lifecycle_manager',
             name='lifecycle_manager_push_map',
             parameters=[{'autostart': True, 'node_names': ['map_server'],
                          'use_sim_time': use_sim_time}], **common),
    ]


def recording(given: Arguments) -> list[Action]:
    """Make the recorder of the topics."""
    if not given['record']:
        return []
    ros2 = shutil.which('ros2')
    if ros2 is None or not is_installed('ros2bag'):
        raise ValueError(f'record: got {given["record"]!r} without ros2bag; expected that it is '
                         'installed')
    namespace = '/' + given['namespace'].strip('/')
    renamed = {**{name: given[name] for name in TOPICS}, 'map': given['map_topic'],
               'clock': given['clock'], 'diagnostics': '/diagnostics'}
    names = [*(renamed.get(name, name) for name in ALL_TOPICS), STATUS, 'tf', 'tf_static']
    topics = [name if name.startswith('/') else f'{namespace.rstrip("/")}/{name}'
              for name in names]
    return [ExecuteProcess(cmd=[ros2, 'bag', 'record', '--output', given['record'], '--topics',
                                *topics, '/rosout'], output='screen')]


def rviz(given: Arguments, common: dict[str, Any]) -> list[Action]:
    """Make RViz, or say that there is none."""
    if not switch('rviz', given['rviz']):
        return []
    if not is_installed('rviz2'):
        return [LogInfo(msg='rviz2 is not installed: RViz is not started')]
    return [Node(package='rviz2', executable='rviz2', name='rviz2', output='screen',
                 namespace=given['namespace'], remappings=common['remappings'],
                 arguments=['-d', PathJoinSubstitution([CONFIG, 'push.rviz'])],
                 parameters=[{'use_sim_time': common['use_sim_time']}],
                 on_exit=Shutdown(reason='RViz was closed'))]
