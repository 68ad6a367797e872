"""
Start simulator, planner and controller, and RViz to set goals.

``ros2 launch push_control simulation_launch.py``, then click 2D Goal Pose in RViz. It includes
``robot_launch.py`` and has all its arguments.
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

# Arguments whose default is another one than without a simulator.
DEFAULTS = {
    'rviz': ('true', 'start RViz, where it is installed'),
    'task': ('true', 'drive around the object and push as often as necessary; else push once from '
             'where the robot stands'),
    'use_sim_time': ('true', 'let the simulator publish the clock, and the nodes follow it; else '
                     'all take the time of the wall'),
    'clock': ('clock', 'topic of the clock: relative, so that every namespace has its own'),
    'map_frame': ('odom', 'frame in which the file of map has its origin'),
}


def generate_launch_description() -> LaunchDescription:
    """Describe the launch arguments, and what is included."""
    robot_launch = str(Path(__file__).with_name('robot_launch.py'))
    return LaunchDescription([
        *[DeclareLaunchArgument(name, default_value=default, description=text)
          for name, (default, text) in DEFAULTS.items()],
        IncludeLaunchDescription(PythonLaunchDescriptionSource(robot_launch),
                                 launch_arguments=[('simulation', 'true')]),
    ])
