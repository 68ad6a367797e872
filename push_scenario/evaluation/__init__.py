"""Metrics of a run and the tables that report them."""
