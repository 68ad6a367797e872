"""Crossings: somebody walks up to a robot with a lidar that is at a task."""
