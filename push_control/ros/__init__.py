"""Controller over ROS 2: its operating modes, their messages and reports."""
