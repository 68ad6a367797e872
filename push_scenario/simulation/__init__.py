"""Closed-loop simulation of a scenario in one process."""
