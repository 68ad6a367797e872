"""Straight pushes at faces, chosen from a table of primitives, on open floor and in maps."""
