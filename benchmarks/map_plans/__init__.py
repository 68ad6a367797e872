"""Benchmark of plans in maps: how narrow passages may be, flats, and how the time grows."""
