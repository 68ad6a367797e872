"""Benchmark of the detector of tags, by images of MuJoCo."""
