"""Controller over ROS 2: the pursuit of goals, its messages and reports."""
