"""Chapter 2: pushes with a rolling contact."""
