"""Planner over ROS 2: requests of tasks and the answers to them."""
