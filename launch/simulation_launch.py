"""
Start simulator, planner and controller, and RViz to set goals.

``ros2 launch push_control simulation_launch.py``, then click 2D Goal Pose in RViz.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, Shutdown
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    """Describe the nodes to start, and the launch arguments."""
    config = PathJoinSubstitution([FindPackageShare('push_control'), 'config'])
    params_file, task = LaunchConfiguration('params_file'), LaunchConfiguration('task')
    wait_for_start = ParameterValue(LaunchConfiguration('wait_for_start'), value_type=bool)
    # With name and namespace given, values set here take precedence over the node's section.
    root = {'namespace': '/', 'output': 'screen', 'on_exit': Shutdown()}
    return LaunchDescription([
        DeclareLaunchArgument(
            'params_file', default_value=PathJoinSubstitution([config, 'push.yaml']),
            description='parameters of the three nodes'),
        DeclareLaunchArgument(
            'task', default_value='true', choices=['true', 'false'],
            description='drive around the object and push as often as necessary; else push once '
                        'from where the robot stands'),
        DeclareLaunchArgument(
            'wait_for_start', default_value='false', choices=['true', 'false'],
            description='push only after a call of the service controller/start'),
        DeclareLaunchArgument(
            'rviz', default_value='true', choices=['true', 'false'],
            description='start RViz'),
        Node(package='push_control', executable='sim', name='push_sim',
             parameters=[params_file, {'autostart': True}], **root),
        Node(package='push_control', executable='planner', name='push_planner',
             condition=IfCondition(task),
             parameters=[params_file, {'planner.site': 'sequence'}], **root),
        Node(package='push_control', executable='planner', name='push_planner',
             condition=UnlessCondition(task), parameters=[params_file], **root),
        Node(package='push_control', executable='controller', name='push_controller',
             parameters=[params_file, {'wait_for_start': wait_for_start,
                                       'task': ParameterValue(task, value_type=bool)}], **root),
        Node(package='rviz2', executable='rviz2',
             condition=IfCondition(LaunchConfiguration('rviz')),
             arguments=['-d', PathJoinSubstitution([config, 'push.rviz'])]),
    ])
