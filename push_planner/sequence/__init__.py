"""Sequences of pushes to any goal: candidates, search, costs and clearance."""
