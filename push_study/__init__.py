"""Studies of pushing: the figures of the thesis, and maps beyond it."""
