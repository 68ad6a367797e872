"""Benchmark: planner."""
