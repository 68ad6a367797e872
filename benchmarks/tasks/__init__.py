"""Benchmark of tasks: random goals that take any number of pushes."""
