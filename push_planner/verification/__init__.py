"""Verification of plans: integrated anew on the equation of motion."""
