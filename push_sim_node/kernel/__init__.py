"""Kernel of the plant: contact, friction and actuation, compiled where numba is installed."""
