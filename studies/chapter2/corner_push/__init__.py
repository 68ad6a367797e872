"""Chapter 2: case study of a box pushed at a corner."""
