"""Benchmark of the calibration: drawn bases and touches, of which the truth is known."""
