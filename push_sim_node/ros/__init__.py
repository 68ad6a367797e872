"""Simulator over ROS 2: outputs and lockstep."""
