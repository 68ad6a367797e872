"""Benchmarks: what README and docs state is measured here."""
