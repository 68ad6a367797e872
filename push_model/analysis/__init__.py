"""Slow pushes with a sliding contact, for many objects or parameters at a time."""
