"""Chapter 2: sketches of the model and of the case studies."""
