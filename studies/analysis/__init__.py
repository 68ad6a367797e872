"""Analyses of the equations of motion: stability, steady turns, limits of rolling, steering."""
