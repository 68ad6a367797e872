"""Chapter 2: case study of a box pushed on a side."""
