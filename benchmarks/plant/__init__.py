"""Benchmark of the simulated plant: accuracy and speed, against MuJoCo."""
