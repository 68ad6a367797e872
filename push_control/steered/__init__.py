"""Steered push: one contact held along a path, by feedback or in open loop."""
