"""Benchmark: plant."""
