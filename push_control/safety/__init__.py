"""Safety: what stops the robot whatever else goes wrong."""
