"""Recorded pushes of a robot: read from bags, split, and what they tell of the object."""
