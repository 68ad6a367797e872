"""
Start planner and controller for a real robot.

The robot and a tracker provide ``odom`` and ``object_pose``, and the robot subscribes ``cmd_vel``;
the arguments remap these topics. The robot moves only after a call of ``controller/start``.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, Shutdown
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

TOPICS = {
    'odom': 'nav_msgs/Odometry of the robot',
    'object_pose': 'geometry_msgs/PoseStamped of the object, in the frame of odom',
    'goal_pose': 'geometry_msgs/PoseStamped, goal pose of the object',
    'map': 'nav_msgs/OccupancyGrid of the obstacles in a task, in the frame of odom; optional',
    'cmd_vel': 'velocity command for the robot',
}


def generate_launch_description():
    """Describe the nodes to start, and the launch arguments."""
    config = PathJoinSubstitution([FindPackageShare('push_control'), 'config'])
    params_file = LaunchConfiguration('params_file')
    remappings = [(topic, LaunchConfiguration(topic)) for topic in TOPICS]
    switches = {name: ParameterValue(LaunchConfiguration(name), value_type=bool)
                for name in ('wait_for_start', 'enable_stamped_cmd_vel')}
    # With name and namespace given, values set here take precedence over the node's section.
    root = {'namespace': '/', 'remappings': remappings, 'output': 'screen', 'on_exit': Shutdown()}
    return LaunchDescription([
        DeclareLaunchArgument(
            'params_file', default_value=PathJoinSubstitution([config, 'push.yaml']),
            description='parameters of both nodes: measure your object and robot first'),
        *[DeclareLaunchArgument(topic, default_value=topic, description=text)
          for topic, text in TOPICS.items()],
        DeclareLaunchArgument(
            'enable_stamped_cmd_vel', default_value='true', choices=['true', 'false'],
            description='command with TwistStamped, else with Twist'),
        DeclareLaunchArgument(
            'wait_for_start', default_value='true', choices=['true', 'false'],
            description='push only after a call of the service controller/start'),
        DeclareLaunchArgument(
            'rviz', default_value='false', choices=['true', 'false'],
            description='start RViz'),
        Node(package='push_control', executable='planner', name='push_planner',
             parameters=[params_file], **root),
        Node(package='push_control', executable='controller', name='push_controller',
             parameters=[params_file, switches], **root),
        Node(package='rviz2', executable='rviz2', remappings=remappings,
             condition=IfCondition(LaunchConfiguration('rviz')),
             arguments=['-d', PathJoinSubstitution([config, 'push.rviz'])]),
    ])
