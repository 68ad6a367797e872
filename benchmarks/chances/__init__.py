"""Benchmark of stated chances: how often tasks and pushes end as their plans have stated."""
