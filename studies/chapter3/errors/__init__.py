"""Chapter 3: errors at the goal of plans whose parameters are wrong."""
