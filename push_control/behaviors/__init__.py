"""Behaviours: what the robot does in each state of a task."""
