"""Scenarios: their definition and their files."""
