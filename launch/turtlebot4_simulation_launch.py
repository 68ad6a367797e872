"""
Start a TurtleBot 4 in MuJoCo with planner and controller, and RViz to set goals.

``ros2 launch push_control turtlebot4_simulation_launch.py``, then click 2D Goal Pose in RViz. It
needs the extra ``mujoco``, includes ``simulation_launch.py`` and has all its arguments.
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

# Arguments whose default is another one than for the simulator of the package.
DEFAULTS = {
    'simulator': ('mujoco_sim', 'which simulator: MuJoCo with wheels and camera, or sim'),
    'robot': ('create3', 'the base of a TurtleBot 4: name in config/robots, or a file'),
    'object': ('box_04', 'object: name in config/objects, or a file'),
    'sensors': ('bumper', 'sensors of the simulator: name in config/sensors, or a file'),
}


def generate_launch_description() -> LaunchDescription:
    """Describe the launch arguments, and what is included."""
    simulation_launch = str(Path(__file__).with_name('simulation_launch.py'))
    return LaunchDescription([
        *[DeclareLaunchArgument(name, default_value=default, description=text)
          for name, (default, text) in DEFAULTS.items()],
        IncludeLaunchDescription(PythonLaunchDescriptionSource(simulation_launch)),
    ])
