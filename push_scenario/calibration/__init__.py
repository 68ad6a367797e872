"""The command that calibrates a base: over ROS, or a simulated one."""
