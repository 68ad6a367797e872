"""Steering laws: from an estimated push to the velocity of the contact and the robot command."""
