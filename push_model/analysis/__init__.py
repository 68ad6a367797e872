"""Analyses on the equations of motion: stability, steady turns, limits of rolling and steering."""
