"""Verification of plans: integrated again on the equation of motion."""
