"""Benchmark: tasks."""
