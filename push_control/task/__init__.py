"""Tasks: behaviours of the robot, and the supervisor that sequences them to the goal."""
