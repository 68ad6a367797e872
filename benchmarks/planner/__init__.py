"""Benchmark of the planner: CPU time, correctness and quality of plans."""
