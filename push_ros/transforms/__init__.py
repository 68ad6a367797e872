"""Transforms between frames: a buffer, its listener on tf, and messages brought to the world."""
