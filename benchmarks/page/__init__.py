"""Frames that the page shows in a second."""
