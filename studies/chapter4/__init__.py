"""Chapter 4: pushes under feedback."""
