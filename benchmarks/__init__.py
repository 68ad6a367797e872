"""Benchmarks: the figures that README and docs state are measured here."""
