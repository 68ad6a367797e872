"""Sequences of pushes to any goal: candidates, search and costs."""
