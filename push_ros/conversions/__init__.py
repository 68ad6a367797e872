"""Conversions between ROS messages and plain values."""
