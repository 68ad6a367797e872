"""Benchmark of rooms with several objects: ``python -m benchmarks.tidy``."""
