"""Studies of pushing: the figures of the thesis, and what lies beyond it."""
