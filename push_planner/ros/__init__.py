"""Planner over ROS 2: requests for push sequences and the answers to them."""
