"""Chapter 3: planned pushes."""
