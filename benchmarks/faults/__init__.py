"""Faults of what comes in and of the base: how each of them ends."""
