"""Scenarios, closed loops over them, and reports of what happened."""
