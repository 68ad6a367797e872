"""Replay of scenarios over DDS, with each node in a process of its own."""
