"""Calibration over ROS."""
